"""The marker tracker's pure step: each colour image becomes the objects in it."""

import math
from collections.abc import Iterable

import numpy as np

from actum import keys
from actum.messages import Image, Message, Objects, TrackedObject
from actum.node import SECOND_NS, Counters, Tick
from actum.stamps import Order, StampGuard
from marker_tracker.catalogue import Carried, Catalogue, Key, plain
from marker_tracker.decoding import Marker
from marker_tracker.images import Camera, UnusableImageError, camera, gray, refuse_black
from marker_tracker.poses import WORST_ERROR_PX, BadPoseError, Pose, confidence, solve
from marker_tracker.rotations import Array
from marker_tracker.scene_file import SceneFileError, load
from marker_tracker.settings import Settings
from marker_tracker.tracks import Sighting, Tracks
from marker_tracker.watching import Watch

OnObject = list[tuple[Marker, Carried]]
LEAST_NOISE_PX = 0.2
LEAST_NOISE_M = 5e-4
FOLLOWED = 0.5
"""How much less a place is trusted that is known by what covers the object alone."""


class MarkerTracker:
    """Finds the objects by the markers on them and says where they are in the skeleton's camera frame."""

    name = "marker_tracker"
    inputs: tuple[keys.Topic, ...] = (keys.COLOR,)

    def __init__(self, settings: Settings) -> None:
        """Read the scene.

        Raises:
            SceneFileError: the scene file cannot be used.
        """
        self.counters = Counters()
        self._settings = settings
        self._catalogue = _catalogue(settings)
        self._watch = Watch(self._catalogue.wanted())
        self._tracks = Tracks(round(settings.memory_s * SECOND_NS))
        self._order = StampGuard()
        self._places_px: dict[Key, Array] = {}

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Answer each colour image with one `Objects` of its stamp, invalid where the image cannot be used."""
        if not isinstance(message, Image) or message.format == "depth16_mm":
            return []
        order = self._order.judge(message.stamp_ns, message.session_id)
        if order is Order.STALE:
            self.counters.reject("stale_stamp", f"image at {message.stamp_ns} after {self._order.newest_ns}")
            return []
        if order is Order.RESTART:
            self._tracks.clear()
            self._watch.clear()
            self._places_px.clear()
        return [self._objects(message)]

    def _objects(self, image: Image) -> Objects:
        if not image.valid:
            return _answer(image, [], image.reason or "the source says so")
        try:
            pixels, view = gray(image), camera(image, self._settings.calibrated_size_px)
            markers = self._watch.markers(image.stamp_ns, pixels)
            if not markers:
                refuse_black(pixels)
        except UnusableImageError as error:
            self.counters.reject(error.kind, f"image at {image.stamp_ns}: {error.detail}")
            return _answer(image, [], str(error))
        for number, of_object in self._carried(self._once(markers)).items():
            self._see(image.stamp_ns, number, of_object, view)
        return _answer(image, self._tracks.listed(image.stamp_ns))

    def _once(self, markers: list[Marker]) -> list[Marker]:
        """Keep of one seen twice the one nearest to where it was, at first the largest."""
        kept: dict[Key, Marker] = {}
        for marker in sorted(markers, key=self._moved_px):
            if kept.setdefault((marker.family, marker.id), marker) is not marker:
                self.counters.reject("repeated_marker", f"marker {marker.id} of {marker.family} twice in one image")
        self._places_px |= {key: marker.centre_px for key, marker in kept.items()}
        return list(kept.values())

    def _moved_px(self, marker: Marker) -> tuple[float, float]:
        place_px = self._places_px.get((marker.family, marker.id))
        return 0.0 if place_px is None else math.dist(marker.centre_px, place_px), -marker.side_px

    def _carried(self, markers: list[Marker]) -> dict[int, OnObject]:
        """Group markers by the objects they are on, the largest first."""
        objects: dict[int, OnObject] = {}
        for marker in sorted(markers, key=lambda one: -one.side_px):
            carried = self._catalogue.find(marker.family, marker.id)
            if carried is None:
                self.counters.reject(
                    "unknown_marker", f"marker {marker.id} of {marker.family} is on none of the objects"
                )
            else:
                objects.setdefault(carried.object_id, []).append((marker, carried))
        return objects

    def _see(self, stamp_ns: int, number: int, listed: OnObject, view: Camera) -> None:
        """Take in an object by those of its markers that show, or else by those that are followed."""
        name = self._catalogue.name(number)
        markers = [it for it in listed if not it[0].hidden] or listed
        try:
            poses = self._poses(name, markers, view)
        except BadPoseError as error:
            self.counters.reject("bad_pose", str(error))
            return
        if not self._tracks.see(stamp_ns, number, name, _sighting(poses, markers, view)):
            self.counters.reject("outlying_pose", f"{name} far from where it was a moment before {stamp_ns}")

    def _poses(self, name: str, markers: OnObject, view: Camera) -> list[Pose]:
        poses = solve(markers, view)
        if len(markers) > 1 and poses[0].error_px > WORST_ERROR_PX:
            ids = ", ".join(str(marker.id) for marker, _ in markers)
            self.counters.reject("markers_disagree", f"markers {ids} of {name} are not where the scene file puts them")
            return solve(markers[:1], view)
        return poses


def _catalogue(settings: Settings) -> Catalogue:
    if settings.scene is None:
        return plain(settings)
    if settings.objects:
        raise SceneFileError("scene and objects both say what carries which marker: set only one of them")
    return load(settings.scene)


def _sighting(poses: list[Pose], markers: OnObject, view: Camera) -> Sighting:
    side_px, hidden = markers[0][0].side_px, markers[0][0].hidden
    return Sighting(
        [Pose(view.skeleton_from_image @ pose.image_from_object, pose.error_px) for pose in poses],
        _noise(poses[0], side_px, view),
        confidence(poses[0], side_px) * (FOLLOWED if hidden else 1.0),
        hidden,
    )


def _noise(pose: Pose, side_px: float, view: Camera) -> Array:
    """Covariance of a position, from the corners' error: along the ray it grows with depth over the marker's side."""
    position_m = pose.image_from_object[:3, 3]
    distance_m = float(np.linalg.norm(position_m))
    corner_px = max(LEAST_NOISE_PX, pose.error_px)
    across_m, along_m = distance_m * corner_px / view.matrix[0, 0], distance_m * corner_px / side_px
    ray = view.skeleton_from_image[:3, :3] @ (position_m / distance_m)
    noise: Array = (along_m**2 - across_m**2) * np.outer(ray, ray) + (across_m**2 + LEAST_NOISE_M**2) * np.eye(3)
    return noise


def _answer(image: Image, objects: list[TrackedObject], reason: str | None = None) -> Objects:
    return Objects(
        stamp_ns=image.stamp_ns,
        sensor=image.sensor,
        valid=reason is None,
        reason=reason,
        objects=objects,
        session_id=image.session_id,
    )
