"""Wholly covered markers: a hand that came to rest on a marker is tracked in the image, for it carries the marker."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Pixels
from actum.node import SECOND_NS
from marker_tracker.detection.marker import Key, Marker
from marker_tracker.occlusion.crop import Crop
from marker_tracker.occlusion.registration import Similarity, Template

RADIUS_SIDES = 0.8
"""Radius of what is tracked, in sides of the marker: a hand is somewhat larger than the marker it covers."""
SIDE_PX = 24.0
"""Pixels: what covers larger markers is tracked in a smaller image, which costs less and is as exact as is needed."""
MAX_RESTING_SIDES_PER_S = 1.0
"""Speed up to which a marker rests: what covers a moving one may cover another place than where it is."""
TAKEN_NS = SECOND_NS // 3
"""Nanoseconds after a marker's last detection in which what comes to rest on it has taken it."""
LEFT_BEHIND_NS = 2 * SECOND_NS
"""Nanoseconds after which what is still near the marker's place may be what was behind it."""
LEFT_BEHIND_SIDES = 0.75
"""Distance, in sides, up to which it is still near."""
MAX_TRACKED = 6
"""Per image: each takes a millisecond or two."""
STILL_NS = SECOND_NS // 20
"""Nanoseconds, at least, between the two images that tell whether something rests on a marker."""
STILL_SIDES = 0.06
"""Motion between the two, in sides, up to which it rests: half a centimetre."""
MIN_STILL_CORRELATION = 0.9
"""Normalised cross-correlation with its first view from which it rests, or is found again far from where expected."""
MIN_CORRELATION = 0.8
"""Normalised cross-correlation with its first view from which it is found where it is expected."""
SEARCH_SIDES = 0.12
"""Distance from where it is expected at which it is searched for, in sides."""
SEARCH_SIDES_PER_S2 = 60.0
"""How that grows with time, as an acceleration: markers of 8 cm are accelerated by up to 5 m/s²."""
MAX_LOG_SCALE = 0.25
"""Natural logarithm of the scale since the first view: a hand with an object moves little towards the camera."""
LOG_SCALE_NOISE = 0.02
"""How far the logarithm of the scale may be from the expected one: what seems to be further off is hidden in part."""
LOG_SCALE_PER_S2 = 5.0
"""How that grows with time, as an acceleration: arms reach that towards the camera."""
OVERLAP_SIDES = 0.5
"""Distance of centres, in sides, below which another marker lies on a marker's place."""


@dataclass(frozen=True)
class LastDetection:
    """A marker where it was detected last, and whether it was at rest there."""

    marker: Marker
    stamp_ns: int
    at_rest: bool

    @property
    def centre_px(self) -> complex:
        """Where the marker was."""
        return complex(*self.marker.centre_px)

    @property
    def scale(self) -> float:
        """Of the image in which its occluder is tracked, at most 1."""
        return min(1.0, SIDE_PX / self.marker.side_px)


@dataclass(frozen=True)
class Occluder:
    """What covers a marker.

    Attributes:
        template: its first view, centred on the marker's place.
        stamp_ns: of the image in which it was found last.
        place: where it was found, against its first view.
        velocity_px_per_ns: between its last two places.
        log_scale_per_ns: smoothed rate of the natural logarithm of its scale.
        rested: it has come to rest on the marker, so that it carries it.
    """

    template: Template
    stamp_ns: int
    place: Similarity
    velocity_px_per_ns: complex = 0.0
    log_scale_per_ns: float = 0.0
    rested: bool = False


class OccluderTracker:
    """Tracks what came to rest on markers that were detected before, and infers where it has carried them."""

    def __init__(self) -> None:
        self._last: dict[Key, LastDetection] = {}
        self._occluders: dict[Key, Occluder] = {}

    def clear(self) -> None:
        """Forget markers and occluders."""
        self._last.clear()
        self._occluders.clear()

    def update(self, stamp_ns: int, pixels: Pixels, visible: Sequence[Marker]) -> list[Marker]:
        """Infer hidden markers from their occluders in a grey image (height, width), given its visible markers."""
        here = {marker.key: self._last_detection(stamp_ns, marker) for marker in visible}
        gone = [(key, last) for key, last in self._last.items() if key not in here and not _lies_under(last, visible)]
        hidden = dict(sorted(gone, key=lambda item: item[0] not in self._occluders)[:MAX_TRACKED])
        tracked = {key: _tracked(stamp_ns, pixels, last, self._occluders.get(key)) for key, last in hidden.items()}
        self._occluders = {key: occluder for key, occluder in tracked.items() if occluder is not None}
        self._last = here | {key: hidden[key] for key in self._occluders}
        return [_carried(hidden[key].marker, each.place) for key, each in self._occluders.items() if each.rested]

    def _last_detection(self, stamp_ns: int, marker: Marker) -> LastDetection:
        """Note where a marker is; it is at rest if it was there a moment ago, too."""
        before = self._last.get(marker.key)
        if before is None:
            return LastDetection(marker, stamp_ns, at_rest=False)
        moved_px = float(np.linalg.norm(marker.centre_px - before.marker.centre_px))
        most_px = MAX_RESTING_SIDES_PER_S * marker.side_px * (stamp_ns - before.stamp_ns) / SECOND_NS
        return LastDetection(marker, stamp_ns, moved_px <= most_px)


def _lies_under(last: LastDetection, visible: Sequence[Marker]) -> bool:
    """Tell whether another marker covers a marker's place: an object lies on it, and no hand."""
    return any(abs(complex(*each.centre_px) - last.centre_px) < OVERLAP_SIDES * last.marker.side_px for each in visible)


def _tracked(stamp_ns: int, pixels: Pixels, last: LastDetection, occluder: Occluder | None) -> Occluder | None:
    """Take a first view of an occluder, wait until it rests, then track it; None where it is lost."""
    if occluder is None:
        return _first_view(stamp_ns, pixels, last) if last.at_rest else None
    if occluder.rested:
        return _followed(stamp_ns, pixels, last, occluder)
    if stamp_ns - occluder.stamp_ns < STILL_NS:
        return occluder
    found = _found(pixels, last, occluder, 0, MIN_STILL_CORRELATION)
    if found is None or not _is_within(STILL_SIDES, found, last):
        return _first_view(stamp_ns, pixels, last)
    return replace(occluder, stamp_ns=stamp_ns, place=found, rested=True)


def _first_view(stamp_ns: int, pixels: Pixels, last: LastDetection) -> Occluder | None:
    """Take what is on a marker's place now as its occluder, if the marker was detected a moment ago."""
    if stamp_ns - last.stamp_ns > TAKEN_NS:
        return None
    crop = Crop.around(pixels, last.centre_px, 2 * RADIUS_SIDES * last.marker.side_px, last.scale)
    centre_px, radius_px = crop.from_image(last.centre_px), RADIUS_SIDES * last.marker.side_px * last.scale
    return Occluder(Template(crop.levels, centre_px, radius_px), stamp_ns, Similarity(last.centre_px))


def _followed(stamp_ns: int, pixels: Pixels, last: LastDetection, occluder: Occluder) -> Occluder | None:
    """Find an occluder again; if something else has come to the marker's place before it moved, begin with that."""
    passed_ns = stamp_ns - occluder.stamp_ns
    if passed_ns > TAKEN_NS:
        return None
    found = _found(pixels, last, occluder, passed_ns, MIN_CORRELATION)
    if found is None:
        return _first_view(stamp_ns, pixels, last) if _is_within(STILL_SIDES, occluder.place, last) else None
    if _is_within(LEFT_BEHIND_SIDES, found, last) and stamp_ns - last.stamp_ns > LEFT_BEHIND_NS:
        return None
    log_scale_per_ns = (_log_scale(found) - _log_scale(occluder.place)) / passed_ns
    return replace(
        occluder,
        stamp_ns=stamp_ns,
        place=found,
        velocity_px_per_ns=(found.centre_px - occluder.place.centre_px) / passed_ns,
        log_scale_per_ns=(log_scale_per_ns + occluder.log_scale_per_ns) / 2,
    )


def _is_within(sides: float, place: Similarity, last: LastDetection) -> bool:
    """Tell whether a place is within so many sides of where the marker was."""
    return abs(place.centre_px - last.centre_px) <= sides * last.marker.side_px


def _found(
    pixels: Pixels, last: LastDetection, occluder: Occluder, passed_ns: int, min_correlation: float
) -> Similarity | None:
    """Register an occluder from where it is expected by now, or else from the best match anywhere near."""
    expected_px = occluder.place.centre_px + occluder.velocity_px_per_ns * passed_ns
    radius_sides = RADIUS_SIDES + SEARCH_SIDES + SEARCH_SIDES_PER_S2 * (passed_ns / SECOND_NS) ** 2 / 2
    crop = Crop.around(pixels, expected_px, radius_sides * last.marker.side_px, last.scale)
    if min(crop.levels.shape) < occluder.template.width_px:
        return None
    found = _registered(crop, occluder, crop.from_image(expected_px), passed_ns, min_correlation)
    if found is None:
        best_px = occluder.template.search(crop.levels)
        found = _registered(crop, occluder, best_px, passed_ns, MIN_STILL_CORRELATION)
    return found


def _registered(
    crop: Crop, occluder: Occluder, start_px: complex, passed_ns: int, min_correlation: float
) -> Similarity | None:
    """Register an occluder from a start in a crop; None where it does not correlate or has another scale."""
    start = Similarity(start_px, occluder.place.scale_rotation)
    found, correlation = occluder.template.register(crop.levels, start)
    if correlation < min_correlation or not _has_plausible_scale(found, occluder, passed_ns):
        return None
    return Similarity(crop.to_image(found.centre_px), found.scale_rotation)


def _has_plausible_scale(found: Similarity, occluder: Occluder, passed_ns: int) -> bool:
    grown = _log_scale(found) - _log_scale(occluder.place) - occluder.log_scale_per_ns * passed_ns
    most = LOG_SCALE_NOISE + LOG_SCALE_PER_S2 * (passed_ns / SECOND_NS) ** 2 / 2
    return abs(_log_scale(found)) <= MAX_LOG_SCALE and abs(grown) <= most


def _log_scale(place: Similarity) -> float:
    return math.log(abs(place.scale_rotation))


def _carried(marker: Marker, place: Similarity) -> Marker:
    """Move a marker's corners with its occluder."""
    around = (marker.corners_px - marker.centre_px) @ [1, 1j]
    corners = place.centre_px + place.scale_rotation * around
    corners_px = np.stack([corners.real, corners.imag], axis=1)
    return replace(marker, corners_px=corners_px, covered=1.0, hidden=True, start=None)
