"""What carries which marker: the one description behind the scene file and the plain settings."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from actum import geometry
from marker_tracker.detection.families import UnknownMarkerError, canonical
from marker_tracker.detection.families import family as family_of
from marker_tracker.settings import Settings

Array = NDArray[np.float64]
Key = tuple[str, int]
"""A marker: its family, by OpenCV's name, and its id there."""


# With y down a marker that faces the camera is close to the identity. With y up it is a half turn, whose rotation
# vector OpenCV gets wrong (by tens of pixels when the marker is exactly frontal).
SQUARE_FROM_MARKER = np.diag([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Carried:
    """A marker on an object: its side, and `object_from_marker` (4, 4).

    The marker frame has its origin in the centre, x to the right, y up, z out of the printed face; its square frame is
    the same with y down and z into it.
    """

    object_id: int
    size_m: float
    object_from_marker: Array = field(default_factory=lambda: np.eye(4))

    @cached_property
    def square_from_object(self) -> Array:
        """Transform (4, 4) to the square frame."""
        transform: Array = SQUARE_FROM_MARKER @ geometry.invert(self.object_from_marker)
        return transform

    @cached_property
    def in_square(self) -> Array:
        """Corners (4, 3) in the square frame, in the order in which they are detected."""
        half = self.size_m / 2
        return np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])

    @cached_property
    def in_object(self) -> Array:
        """Corners (4, 3) in the object's frame."""
        return geometry.apply(self.object_from_marker @ SQUARE_FROM_MARKER, self.in_square)


@dataclass(frozen=True)
class Catalogue:
    """Markers and the names of the objects that carry them.

    Where `open_size_m` is set every marker of `families` counts, each an object of its own id.
    """

    families: tuple[str, ...]
    markers: Mapping[Key, Carried]
    names: Mapping[int, str]
    open_size_m: float | None = None

    def wanted(self) -> dict[str, set[int]]:
        """Name the ids to be searched in each family; none: all."""
        return {name: {number for family, number in self.markers if family == name} for name in self.families}

    def find(self, family: str, marker_id: int) -> Carried | None:
        """Look up what a marker is on."""
        if self.open_size_m is not None:
            return Carried(marker_id, self.open_size_m)
        return self.markers.get((family, marker_id))

    def name(self, object_id: int) -> str:
        """Look up an object's name."""
        return self.names.get(object_id, f"marker {object_id}")


def plain(settings: Settings) -> Catalogue:
    """Describe the settings' objects: each carries the marker of its own id, in its centre.

    Raises:
        UnknownMarkerError: the dictionary has no such marker.
    """
    family = canonical(settings.dictionary)
    if not settings.objects:
        return Catalogue((family,), {}, {}, settings.marker_size_m)
    ids = len(family_of(family).codes)
    for number in settings.objects:
        if not 0 <= number < ids:
            raise UnknownMarkerError(f"objects: {family} has no marker {number}: use 0 to {ids - 1}")
    markers = {
        (family, number): Carried(number, spec.size_m or settings.marker_size_m)
        for number, spec in settings.objects.items()
    }
    return Catalogue((family,), markers, {number: spec.name for number, spec in settings.objects.items()})
