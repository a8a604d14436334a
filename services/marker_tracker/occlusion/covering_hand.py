"""What covers a marker, followed in the image: a hand that takes an object by its marker carries both."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from marker_tracker.detection.decoding import Marker
from marker_tracker.detection.images import Pixels
from marker_tracker.occlusion.registration import Patch, Similarity, blurred

Array = NDArray[np.float64]
Key = tuple[str, int]

REACH = 0.8
"""Radius of what is followed, in sides of the marker."""
SIDE_PX = 24.0
"""Larger markers are followed in a smaller image."""
RESTING = 1.0
"""Sides per second up to which a marker rests: what is covered as it moves is not known to be where it was."""
TAKEN_NS = SECOND_NS // 3
"""What comes to rest on a marker within this time of its last sighting has taken it."""
RESTS_NS, RESTS = 2 * SECOND_NS, 0.75
"""What stays within so many sides of a marker's place for longer may be what was behind it."""
MOST_FOLLOWED = 6
"""Each takes a millisecond or two of every image."""
STILL_NS, STILL = SECOND_NS // 20, 0.06
"""What covers a marker rests on it where it moves by less than this part of a side in this time or a little more."""
STILL_ALIKE, ALIKE = 0.9, 0.8
"""Correlation with how it looked before from which it is at rest, and from which it is still what it was."""
NEAR, SIDES_PER_S2 = 0.12, 60.0
"""How far from where it is expected it is looked for, in sides of the marker: 8 cm are sped up by up to 5 m/s²."""
GROWTH = 0.25
"""How much it may grow or shrink in all: its logarithm."""
SIZE_NOISE, GROWTH_PER_S2 = 0.02, 5.0
"""How much larger or smaller than expected it may be; what seems to be more is hidden in part."""
SAME_PLACE = 0.5
"""Within this of a marker's place, in sides of it, another marker lies on it."""
HALF = 0.5 + 0.5j
"""From a pixel's corner to its middle."""


@dataclass(frozen=True)
class Seen:
    """A marker when it was last seen: at rest or not."""

    marker: Marker
    stamp_ns: int
    rests: bool

    @property
    def middle_px(self) -> complex:
        """Where it was."""
        return complex(*self.marker.centre_px)

    @property
    def scale(self) -> float:
        """How much smaller the image is made in which its cover is followed."""
        return min(1.0, SIDE_PX / self.marker.side_px)


@dataclass(frozen=True)
class Cover:
    """What is on a marker's place, how it looked first, and once it `rested` there where it has gone since.

    `place` is where it was at `stamp_ns`.
    """

    patch: Patch
    stamp_ns: int
    place: Similarity
    px_per_ns: complex = 0.0
    growth_per_ns: float = 0.0
    rested: bool = False


class Covers:
    """Remembers the markers that were seen, and tells where what came to rest on them has gone."""

    def __init__(self) -> None:
        self._seen: dict[Key, Seen] = {}
        self._covers: dict[Key, Cover] = {}

    def clear(self) -> None:
        """Forget everything: the source has started anew."""
        self._seen.clear()
        self._covers.clear()

    def followed(self, stamp_ns: int, pixels: Pixels, found: Sequence[Marker]) -> list[Marker]:
        """Place markers that are not among those found in a grey image (height, width) where what covers them is."""
        here = {(marker.family, marker.id): self._sight(stamp_ns, marker) for marker in found}
        gone = [(key, seen) for key, seen in self._seen.items() if key not in here and not _lies_under(seen, found)]
        hidden = dict(sorted(gone, key=lambda one: one[0] not in self._covers)[:MOST_FOLLOWED])
        covers = {key: _next(stamp_ns, pixels, seen, self._covers.get(key)) for key, seen in hidden.items()}
        self._covers = {key: cover for key, cover in covers.items() if cover is not None}
        self._seen = here | {key: hidden[key] for key in self._covers}
        return [_carried(hidden[key].marker, cover.place) for key, cover in self._covers.items() if cover.rested]

    def _sight(self, stamp_ns: int, marker: Marker) -> Seen:
        """Note where a marker is, and whether it is where it was a moment ago."""
        before = self._seen.get((marker.family, marker.id))
        if before is None:
            return Seen(marker, stamp_ns, rests=False)
        moved_px = float(np.linalg.norm(marker.centre_px - before.marker.centre_px))
        return Seen(marker, stamp_ns, moved_px <= RESTING * marker.side_px * (stamp_ns - before.stamp_ns) / SECOND_NS)


def _lies_under(seen: Seen, found: Sequence[Marker]) -> bool:
    """Tell whether another marker is where one was: that one's object is another."""
    return any(abs(complex(*one.centre_px) - seen.middle_px) < SAME_PLACE * seen.marker.side_px for one in found)


def _next(stamp_ns: int, pixels: Pixels, seen: Seen, cover: Cover | None) -> Cover | None:
    """Begin to watch what covers a marker, see whether it rests, or follow it; None where nothing is known of it."""
    if cover is None:
        return _begun(stamp_ns, pixels, seen) if seen.rests else None
    if cover.rested:
        return _followed(stamp_ns, pixels, seen, cover)
    if stamp_ns - cover.stamp_ns < STILL_NS:
        return cover
    return _resting(stamp_ns, pixels, seen, cover) or _begun(stamp_ns, pixels, seen)


def _begun(stamp_ns: int, pixels: Pixels, seen: Seen) -> Cover | None:
    """Take what is on a marker's place as it looks now, soon after the marker was seen there."""
    if stamp_ns - seen.stamp_ns > TAKEN_NS:
        return None
    view = View.around(pixels, seen.middle_px, 2 * REACH * seen.marker.side_px, seen.scale)
    patch = Patch(view.levels, view.inside(seen.middle_px), REACH * seen.marker.side_px * seen.scale)
    return Cover(patch, stamp_ns, Similarity(seen.middle_px))


def _resting(stamp_ns: int, pixels: Pixels, seen: Seen, cover: Cover) -> Cover | None:
    """Take what covers a marker as resting on it, if it has hardly moved."""
    found = _found(pixels, seen, cover, 0, STILL_ALIKE)
    if found is None or not _is_within(STILL, found, seen):
        return None
    return replace(cover, stamp_ns=stamp_ns, place=found, rested=True)


def _followed(stamp_ns: int, pixels: Pixels, seen: Seen, cover: Cover) -> Cover | None:
    """Follow what covers a marker; where something else now lies there, begin with that."""
    passed_ns = stamp_ns - cover.stamp_ns
    if passed_ns > TAKEN_NS:
        return None
    found = _found(pixels, seen, cover, passed_ns, ALIKE)
    if found is None:
        return _begun(stamp_ns, pixels, seen) if _is_within(STILL, cover.place, seen) else None
    if _is_within(RESTS, found, seen) and stamp_ns - seen.stamp_ns > RESTS_NS:
        return None
    px_per_ns = (found.middle_px - cover.place.middle_px) / passed_ns
    growth_per_ns = (_size(found) - _size(cover.place)) / passed_ns
    return replace(
        cover,
        stamp_ns=stamp_ns,
        place=found,
        px_per_ns=px_per_ns,
        growth_per_ns=(growth_per_ns + cover.growth_per_ns) / 2,
    )


def _is_within(sides: float, place: Similarity, seen: Seen) -> bool:
    """Tell whether a place is within so many sides of where the marker was."""
    return abs(place.middle_px - seen.middle_px) <= sides * seen.marker.side_px


def _found(pixels: Pixels, seen: Seen, cover: Cover, passed_ns: int, least_alike: float) -> Similarity | None:
    """Find what covers a marker where it is to be by now, or else anywhere near."""
    expected_px = cover.place.middle_px + cover.px_per_ns * passed_ns
    reach = REACH + NEAR + SIDES_PER_S2 * (passed_ns / SECOND_NS) ** 2 / 2
    view = View.around(pixels, expected_px, reach * seen.marker.side_px, seen.scale)
    if min(view.levels.shape) < len(cover.patch.levels):
        return None
    starts = (view.inside(expected_px), least_alike), (cover.patch.near(view.levels), STILL_ALIKE)
    for start_px, least in starts:
        found, alike = cover.patch.found(view.levels, Similarity(start_px, cover.place.turn))
        if alike >= least and _is_as_large(found, cover, passed_ns):
            return Similarity(view.outside(found.middle_px), found.turn)
    return None


def _is_as_large(found: Similarity, cover: Cover, passed_ns: int) -> bool:
    """Tell whether it has about the size that it is to have by now."""
    grown = _size(found) - _size(cover.place) - cover.growth_per_ns * passed_ns
    most = SIZE_NOISE + GROWTH_PER_S2 * (passed_ns / SECOND_NS) ** 2 / 2
    return abs(_size(found)) <= GROWTH and abs(grown) <= most


def _size(place: Similarity) -> float:
    """How large it is beside how it looked first: the logarithm."""
    return math.log(abs(place.turn))


def _carried(marker: Marker, place: Similarity) -> Marker:
    """Bring a marker to where what covers it is, as that has turned and grown."""
    around = (marker.corners_px - marker.centre_px) @ [1, 1j]
    corners = place.middle_px + place.turn * around
    corners_px = np.stack([corners.real, corners.imag], axis=1)
    return replace(marker, corners_px=corners_px, covered=1.0, hidden=True, start=None)


@dataclass(frozen=True)
class View:
    """Part of an image, made smaller by `scale`, without noise; `corner_px` is its top left pixel."""

    levels: Array
    corner_px: complex
    scale: float

    @classmethod
    def around(cls, pixels: Pixels, middle_px: complex, radius_px: float, scale: float) -> Self:
        """Look at what is within a radius of a place."""
        left, top = max(round(middle_px.real - radius_px), 0), max(round(middle_px.imag - radius_px), 0)
        right, bottom = max(round(middle_px.real + radius_px), 0) + 1, max(round(middle_px.imag + radius_px), 0) + 1
        part = pixels[top:bottom, left:right]
        if scale * min(part.shape) < 1:
            part = part[:0, :0]
        elif scale < 1:
            part = np.asarray(cv2.resize(part, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        return cls(blurred(part), complex(left, top), scale)

    def inside(self, point_px: complex) -> complex:
        """Turn a place in the image into one in the view."""
        return (point_px - self.corner_px + HALF) * self.scale - HALF

    def outside(self, point_px: complex) -> complex:
        """Turn a place in the view into one in the image."""
        return (point_px + HALF) / self.scale - HALF + self.corner_px
