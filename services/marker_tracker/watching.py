"""Markers from image to image: what is still in its place needs no search, which costs more than all the rest."""

from collections.abc import Collection, Mapping

from actum.node import SECOND_NS
from marker_tracker.detection.decoding import Marker
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.images import Pixels
from marker_tracker.occlusion.covering_hand import Covers
from marker_tracker.occlusion.partly_covered import Follower

SEARCHED_NS = SECOND_NS // 3
"""Images are searched as a whole at least this often: others' markers and second copies are to be told, too."""
MISSING_NS = SECOND_NS // 20
"""While a marker is missing, they are searched this often, which is every image of a slow camera."""


class Watch:
    """Finds markers where they were, by searching, by what shows of them under a hand, and by the hand."""

    def __init__(self, wanted: Mapping[str, Collection[int]]) -> None:
        """Watch for these ids of these families, or for all of a family where there are none."""
        self._detector = MarkerDetector(wanted)
        self._follower = Follower()
        self._covers = Covers()
        self._last: list[Marker] = []
        self._searched_ns = 0
        self._shape: tuple[int, ...] = ()

    def clear(self) -> None:
        """Forget everything: the source has started anew."""
        self._follower.clear()
        self._covers.clear()
        self._last = []
        self._searched_ns = 0

    def markers(self, stamp_ns: int, pixels: Pixels) -> list[Marker]:
        """Find the markers of the next grey image (height, width), and the hidden ones that are carried."""
        if pixels.shape != self._shape:
            self.clear()
            self._shape = pixels.shape
        due = self._is_due(stamp_ns)
        read = self._detector.read_in_place if due else self._detector.read_again
        here = read(pixels, self._last)
        if due or len(here) < max(1, len(self._last)):
            here = self._detector.detect(pixels, here)
            self._searched_ns = stamp_ns
        self._last = here
        found = self._follower.followed(stamp_ns, pixels, here)
        return [*found, *self._covers.followed(stamp_ns, pixels, found)]

    def _is_due(self, stamp_ns: int) -> bool:
        """Tell whether an image is to be searched though all the last ones may be in their places."""
        often_ns = SEARCHED_NS if self._detector.is_complete(self._last) else MISSING_NS
        return stamp_ns - self._searched_ns >= often_ns
