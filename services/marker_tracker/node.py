"""The marker tracker's pure step: from each colour image, by detection, occlusion and pose, to the objects in it."""

from collections.abc import Iterable

from actum import keys
from actum.images import UnusableImageError, gray, refuse_black
from actum.messages import Image, Message, Objects, TrackedObject
from actum.node import SECOND_NS, Counters, Tick
from actum.stamps import Order, StampGuard
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.occlusion.occluder_tracker import OccluderTracker
from marker_tracker.occlusion.partial_occlusion import PartialOcclusionTracker
from marker_tracker.pose.camera_model import camera_model
from marker_tracker.pose.catalogue import MarkerAssignment
from marker_tracker.pose.pose_tracks import Tracks
from marker_tracker.pose.poses import measure
from marker_tracker.scene_file import catalogue
from marker_tracker.settings import Settings


class MarkerTracker:
    """Finds the objects by the markers on them and says where they are in the skeleton's camera frame."""

    name = "marker_tracker"
    inputs: tuple[keys.Topic, ...] = (keys.COLOR,)

    def __init__(self, settings: Settings) -> None:
        """Read the scene.

        Raises:
            SceneFileError: the scene file cannot be used.
            UnknownMarkerError: the settings name a marker that its dictionary does not have.
        """
        self.counters = Counters()
        self._calibrated_size_px = settings.calibrated_size_px
        self._order = StampGuard()
        self._image_shape: tuple[int, ...] = ()
        scene = catalogue(settings)
        self._detector = MarkerDetector(scene.wanted())
        self._partial_occlusion = PartialOcclusionTracker()
        self._occluders = OccluderTracker()
        self._assignment = MarkerAssignment(scene, self.counters)
        self._tracks = Tracks(round(settings.memory_s * SECOND_NS))

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Return one `Objects` with the stamp of each colour image, invalid where the image cannot be used."""
        if not isinstance(message, Image) or message.format == "depth16_mm":
            return []
        order = self._order.judge(message.stamp_ns, message.session_id)
        if order is Order.STALE:
            self.counters.reject("stale_stamp", f"image at {message.stamp_ns} after {self._order.newest_ns}")
            return []
        if order is Order.RESTART:
            self._forget_images()
            self._assignment.clear()
            self._tracks.clear()
        if not message.valid:
            return [_answer(message, [], message.reason or "the source says so")]
        try:
            return [_answer(message, self._objects(message))]
        except UnusableImageError as error:
            self.counters.reject(error.kind, f"image at {message.stamp_ns}: {error.detail}")
            return [_answer(message, [], str(error))]

    def _objects(self, image: Image) -> list[TrackedObject]:
        """Detect markers, add the covered ones, measure the poses of their objects, and update the tracks."""
        stamp_ns, pixels, camera = image.stamp_ns, gray(image), camera_model(image, self._calibrated_size_px)
        if pixels.shape != self._image_shape:
            self._forget_images()
            self._image_shape = pixels.shape
        markers = self._detector.detect(stamp_ns, pixels)
        markers = self._partial_occlusion.update(stamp_ns, pixels, markers)
        markers = [*markers, *self._occluders.update(stamp_ns, pixels, markers)]
        if not markers:
            refuse_black(pixels)
        measurements = measure(self._assignment.objects(markers), camera, self.counters)
        for outlier in self._tracks.update(stamp_ns, measurements):
            self.counters.reject("outlying_pose", f"{outlier.name} far from where it was a moment before {stamp_ns}")
        return self._tracks.listed(stamp_ns)

    def _forget_images(self) -> None:
        """Forget the markers of previous images: the next image has another session or size."""
        self._detector.clear()
        self._partial_occlusion.clear()
        self._occluders.clear()


def _answer(image: Image, objects: list[TrackedObject], reason: str | None = None) -> Objects:
    return Objects(
        stamp_ns=image.stamp_ns,
        sensor=image.sensor,
        valid=reason is None,
        reason=reason,
        objects=objects,
        session_id=image.session_id,
    )
