"""The catalogue of objects and their markers, and the assignment of an image's markers to the objects."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from actum import geometry
from actum.arrays import Array
from actum.node import Counters
from marker_tracker.detection.marker import Key, Marker

SQUARE_FROM_MARKER = np.diag([1.0, -1.0, -1.0, 1.0])
"""Transform (4, 4) that turns y down. In the square frame, a marker that faces the camera has a rotation near the
identity. In the marker frame it would be a half turn, whose rotation vector OpenCV gets wrong by tens of pixels when
the marker is exactly frontal."""


@dataclass(frozen=True, eq=False)
class MountedMarker:
    """A marker on an object.

    The marker frame has its origin in the centre, x to the right, y up, z out of the printed face. The square frame is
    the same with y down and z into the face.

    Attributes:
        object_id: of the object.
        size_m: side of the black square.
        object_from_marker: rigid transform (4, 4).
    """

    object_id: int
    size_m: float
    object_from_marker: Array = field(default_factory=lambda: np.eye(4))

    @cached_property
    def square_from_object(self) -> Array:
        """Rigid transform (4, 4) in metres from the object's frame to the square frame."""
        transform: Array = SQUARE_FROM_MARKER @ geometry.invert(self.object_from_marker)
        return transform

    @cached_property
    def corners_in_square_m(self) -> Array:
        """Corners (4, 3) in the square frame, in metres and in the order of `Marker.corners_px`."""
        half = self.size_m / 2
        return np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])

    @cached_property
    def corners_in_object_m(self) -> Array:
        """Corners (4, 3) in the object's frame, in metres and in the same order."""
        return geometry.apply(self.object_from_marker @ SQUARE_FROM_MARKER, self.corners_in_square_m)


@dataclass(frozen=True)
class Catalogue:
    """The scene's markers and objects.

    Attributes:
        families: names of the families to search.
        markers: the mounting of each marker, by its key.
        names: of the objects, by id.
        open_size_m: if set, every marker of the families is an object of its own id, and this is its side.
    """

    families: tuple[str, ...]
    markers: Mapping[Key, MountedMarker]
    names: Mapping[int, str]
    open_size_m: float | None = None

    def wanted(self) -> dict[str, set[int]]:
        """List the ids to be searched in each family, by the family's name; no ids stand for all."""
        return {name: {number for family, number in self.markers if family == name} for name in self.families}

    def find(self, family: str, marker_id: int) -> MountedMarker | None:
        """Look up a marker's mounting; None where it is on none of the objects."""
        if self.open_size_m is not None:
            return MountedMarker(marker_id, self.open_size_m)
        return self.markers.get((family, marker_id))


@dataclass(frozen=True)
class MarkedObject:
    """An object in an image, with the markers that its pose is estimated from, the largest first."""

    id: int
    name: str
    markers: Sequence[tuple[Marker, MountedMarker]]


class MarkerAssignment:
    """Assigns the markers of each image to the catalogue's objects."""

    def __init__(self, catalogue: Catalogue, counters: Counters) -> None:
        """Assign to the catalogue's objects; count markers that are on none of them, or twice in an image."""
        self._catalogue = catalogue
        self._counters = counters
        self._last_px: dict[Key, Array] = {}

    def clear(self) -> None:
        """Forget where markers were."""
        self._last_px.clear()

    def objects(self, markers: Sequence[Marker]) -> list[MarkedObject]:
        """Group an image's markers by object; leave out the hidden markers of objects that have visible ones."""
        by_object: dict[int, list[tuple[Marker, MountedMarker]]] = {}
        for marker in sorted(self._without_copies(markers), key=lambda each: -each.side_px):
            mounting = self._catalogue.find(*marker.key)
            if mounting is None:
                detail = f"marker {marker.id} of {marker.family} is on none of the objects"
                self._counters.reject("unknown_marker", detail)
            else:
                by_object.setdefault(mounting.object_id, []).append((marker, mounting))
        names = self._catalogue.names
        return [
            MarkedObject(
                number, names.get(number, f"marker {number}"), [pair for pair in pairs if not pair[0].hidden] or pairs
            )
            for number, pairs in by_object.items()
        ]

    def _without_copies(self, markers: Sequence[Marker]) -> list[Marker]:
        """Keep one copy of each marker: the one nearest to its last place, or the largest where there is none."""
        kept: dict[Key, Marker] = {}
        for marker in sorted(markers, key=self._moved_px):
            if kept.setdefault(marker.key, marker) is not marker:
                self._counters.reject("repeated_marker", f"marker {marker.id} of {marker.family} twice in one image")
        self._last_px |= {key: marker.centre_px for key, marker in kept.items()}
        return list(kept.values())

    def _moved_px(self, marker: Marker) -> tuple[float, float]:
        last_px = self._last_px.get(marker.key)
        return 0.0 if last_px is None else math.dist(marker.centre_px, last_px), -marker.side_px
