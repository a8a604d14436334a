"""The marker tracker's pure step: each colour image becomes the objects in it."""

from collections.abc import Iterable

from actum import keys
from actum.messages import Image, Message, Objects, TrackedObject
from actum.node import SECOND_NS, Tally, Tick
from actum.stamps import Order, StampGuard
from marker_tracker.detection import BadPoseError, Marker, MarkerDetector, confidence, locate, quaternion_xyzw
from marker_tracker.images import Camera, UnusableImageError, camera, gray
from marker_tracker.memory import Memory
from marker_tracker.settings import ObjectSpec, Settings


class MarkerTracker:
    """Finds the objects by the markers on them and says where they are in the skeleton's camera frame."""

    name = "marker_tracker"
    inputs: tuple[keys.Topic, ...] = (keys.COLOR,)

    def __init__(self, settings: Settings) -> None:
        self.tally = Tally()
        self._settings = settings
        self._detector = MarkerDetector(settings.dictionary)
        self._memory = Memory(round(settings.memory_s * SECOND_NS))
        self._order = StampGuard()

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Answer each colour image with one `Objects` of its stamp, invalid where the image cannot be used."""
        if not isinstance(message, Image) or message.format == "depth16_mm":
            return []
        order = self._order.judge(message.stamp_ns, message.session_id)
        if order is Order.STALE:
            self.tally.reject("stale_stamp", f"image at {message.stamp_ns} after {self._order.newest_ns}")
            return []
        if order is Order.RESTART:
            self._memory.clear()
        return [self._objects(message)]

    def _objects(self, image: Image) -> Objects:
        if not image.valid:
            return _answer(image, [], image.reason or "the source says so")
        try:
            seen = self._seen(image)
        except UnusableImageError as error:
            self.tally.reject(error.kind, f"image at {image.stamp_ns}: {error.detail}")
            return _answer(image, [], str(error))
        return _answer(image, self._memory.update(image.stamp_ns, seen))

    def _seen(self, image: Image) -> list[TrackedObject]:
        view, pixels = camera(image), gray(image)
        found: dict[int, TrackedObject] = {}
        for marker in self._detector.detect(pixels):
            tracked = self._tracked(marker, view)
            if tracked is None:
                continue
            if tracked.id in found:
                self.tally.reject("repeated_marker", f"marker {tracked.id} twice in the image at {image.stamp_ns}")
            found[tracked.id] = max(tracked, found.get(tracked.id, tracked), key=lambda one: one.confidence)
        return list(found.values())

    def _tracked(self, marker: Marker, view: Camera) -> TrackedObject | None:
        spec = self._spec(marker.id)
        if spec is None:
            self.tally.reject("unknown_marker", f"marker {marker.id} is on none of the objects of the settings")
            return None
        try:
            pose = locate(marker, spec.size_m or self._settings.marker_size_m, view)
        except BadPoseError as error:
            self.tally.reject("bad_pose", str(error))
            return None
        skeleton_from_marker = view.skeleton_from_image @ pose.image_from_marker
        return TrackedObject(
            id=marker.id,
            name=spec.name,
            position_m=skeleton_from_marker[:3, 3].tolist(),
            quaternion_xyzw=quaternion_xyzw(skeleton_from_marker[:3, :3]),
            confidence=confidence(pose, marker.side_px),
            seen=True,
        )

    def _spec(self, marker_id: int) -> ObjectSpec | None:
        if not self._settings.objects:
            return ObjectSpec(name=f"marker {marker_id}")
        return self._settings.objects.get(marker_id)


def _answer(image: Image, objects: list[TrackedObject], reason: str | None = None) -> Objects:
    return Objects(
        stamp_ns=image.stamp_ns,
        sensor=image.sensor,
        valid=reason is None,
        reason=reason,
        objects=objects,
        session_id=image.session_id,
    )
