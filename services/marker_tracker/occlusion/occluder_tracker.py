"""Wholly covered markers: a hand that came to rest on a marker is tracked in the image, and the marker moves with it.

Lengths in sides are multiples of the marker's mean side in the image.
"""

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
"""Radius of the tracked disc, in sides: a hand is somewhat larger than the marker it covers."""
SIDE_PX = 24.0
"""Largest side in pixels: the image is scaled down for larger markers, which costs less and is accurate enough."""
MAX_RESTING_SIDES_PER_S = 1.0
"""Largest speed of a marker at rest: a moving marker may have left the place where it was detected last."""
MAX_UNDETECTED_NS = SECOND_NS // 3
"""Nanoseconds after a marker's last detection in which its occluder is first viewed, and after an occluder's last
registration in which it is searched for."""
LEFT_BEHIND_NS = 2 * SECOND_NS
"""Nanoseconds since the last detection after which an occluder near the marker's place is given up: it may be the
background."""
LEFT_BEHIND_SIDES = 0.75
"""Distance in sides up to which an occluder is near the marker's place."""
MAX_TRACKED = 6
"""Occluders per image: each takes a millisecond or two."""
STILL_NS = SECOND_NS // 20
"""Shortest time in nanoseconds between the two images by which an occluder is judged to rest."""
STILL_SIDES = 0.06
"""Motion in sides between those two images up to which an occluder rests: half a centimetre."""
MIN_STILL_CORRELATION = 0.9
"""Least normalised cross-correlation with the first view, for an occluder that rests or is far from its prediction."""
MIN_CORRELATION = 0.8
"""Least normalised cross-correlation with the first view, for an occluder at its predicted position."""
SEARCH_SIDES = 0.12
"""Search radius around the predicted position, in sides."""
SEARCH_SIDES_PER_S2 = 60.0
"""Growth of the search radius with time, as an acceleration: markers of 8 cm are accelerated by up to 5 m/s²."""
MAX_LOG_SCALE = 0.25
"""Natural logarithm of the scale since the first view: a hand with an object moves little towards the camera."""
LOG_SCALE_NOISE = 0.02
"""Largest error of the predicted logarithm of the scale: a larger one means that the occluder is hidden in part."""
LOG_SCALE_PER_S2 = 5.0
"""Growth of that error with time, as an acceleration: arms reach that towards the camera."""
OVERLAP_SIDES = 0.5
"""Distance of centres in sides below which another marker covers a marker's place: an object lies on it, no hand."""


@dataclass(frozen=True)
class LastDetection:
    """A marker as it was detected last, and whether it was at rest then."""

    marker: Marker
    stamp_ns: int
    at_rest: bool

    @property
    def centre_px(self) -> complex:
        """The marker's centre in the image, as x + i y."""
        return complex(*self.marker.centre_px)

    @property
    def scale(self) -> float:
        """Scale of the image in which the occluder is tracked, at most 1."""
        return min(1.0, SIDE_PX / self.marker.side_px)


@dataclass(frozen=True)
class Occluder:
    """Whatever covers a marker, usually a hand.

    Attributes:
        template: its first view, centred on the marker's last position.
        stamp_ns: of the image in which it was registered last.
        place: the registration of the template with that image.
        velocity_px_per_ns: between its last two places, as x + i y.
        log_scale_per_ns: smoothed rate of the natural logarithm of its scale.
        rested: whether it has come to rest on the marker, which from then on moves with it.
    """

    template: Template
    stamp_ns: int
    place: Similarity
    velocity_px_per_ns: complex = 0.0
    log_scale_per_ns: float = 0.0
    rested: bool = False


class OccluderTracker:
    """Tracks the occluders of markers that are no longer detected, and infers the markers' positions from them."""

    def __init__(self) -> None:
        self._last: dict[Key, LastDetection] = {}
        self._occluders: dict[Key, Occluder] = {}

    def clear(self) -> None:
        """Forget markers and occluders."""
        self._last.clear()
        self._occluders.clear()

    def update(self, stamp_ns: int, pixels: Pixels, visible: Sequence[Marker]) -> list[Marker]:
        """Infer hidden markers from their occluders in a grey image (height, width), given its visible markers."""
        detected = {marker.key: self._last_detection(stamp_ns, marker) for marker in visible}
        missing = [
            (key, last)
            for key, last in self._last.items()
            if key not in detected
            and not any(
                abs(complex(*each.centre_px) - last.centre_px) < OVERLAP_SIDES * last.marker.side_px for each in visible
            )
        ]
        hidden = dict(sorted(missing, key=lambda item: item[0] not in self._occluders)[:MAX_TRACKED])
        tracked = {key: _tracked(stamp_ns, pixels, last, self._occluders.get(key)) for key, last in hidden.items()}
        self._occluders = {key: occluder for key, occluder in tracked.items() if occluder is not None}
        self._last = detected | {key: hidden[key] for key in self._occluders}
        return [_moved_with(hidden[key].marker, each.place) for key, each in self._occluders.items() if each.rested]

    def _last_detection(self, stamp_ns: int, marker: Marker) -> LastDetection:
        """Describe a marker's detection; it is at rest if it has moved slowly since the previous one."""
        before = self._last.get(marker.key)
        if before is None:
            return LastDetection(marker, stamp_ns, at_rest=False)
        moved_px = float(np.linalg.norm(marker.centre_px - before.marker.centre_px))
        most_px = MAX_RESTING_SIDES_PER_S * marker.side_px * (stamp_ns - before.stamp_ns) / SECOND_NS
        return LastDetection(marker, stamp_ns, moved_px <= most_px)


def _tracked(stamp_ns: int, pixels: Pixels, last: LastDetection, occluder: Occluder | None) -> Occluder | None:
    """Update an occluder: take its first view, wait until it rests, then track it; None where it is lost."""
    if occluder is None:
        return _first_view(stamp_ns, pixels, last) if last.at_rest else None
    if occluder.rested:
        return _registered_again(stamp_ns, pixels, last, occluder)
    if stamp_ns - occluder.stamp_ns < STILL_NS:
        return occluder
    place = _located(pixels, last, occluder, 0, MIN_STILL_CORRELATION)
    if place is None or not _is_within(STILL_SIDES, place, last):
        return _first_view(stamp_ns, pixels, last)
    return replace(occluder, stamp_ns=stamp_ns, place=place, rested=True)


def _first_view(stamp_ns: int, pixels: Pixels, last: LastDetection) -> Occluder | None:
    """Make an occluder of the image at a marker's last position, if the marker was detected a moment ago."""
    if stamp_ns - last.stamp_ns > MAX_UNDETECTED_NS:
        return None
    crop = Crop.around(pixels, last.centre_px, 2 * RADIUS_SIDES * last.marker.side_px, last.scale)
    centre_px, radius_px = crop.from_image(last.centre_px), RADIUS_SIDES * last.marker.side_px * last.scale
    return Occluder(Template(crop.levels, centre_px, radius_px), stamp_ns, Similarity(last.centre_px))


def _registered_again(stamp_ns: int, pixels: Pixels, last: LastDetection, occluder: Occluder) -> Occluder | None:
    """Locate a resting occluder again; one that is lost before it moved is replaced by a new first view."""
    passed_ns = stamp_ns - occluder.stamp_ns
    if passed_ns > MAX_UNDETECTED_NS:
        return None
    place = _located(pixels, last, occluder, passed_ns, MIN_CORRELATION)
    if place is None:
        return _first_view(stamp_ns, pixels, last) if _is_within(STILL_SIDES, occluder.place, last) else None
    if _is_within(LEFT_BEHIND_SIDES, place, last) and stamp_ns - last.stamp_ns > LEFT_BEHIND_NS:
        return None
    log_scale_per_ns = (_log_scale(place) - _log_scale(occluder.place)) / passed_ns
    return replace(
        occluder,
        stamp_ns=stamp_ns,
        place=place,
        velocity_px_per_ns=(place.centre_px - occluder.place.centre_px) / passed_ns,
        log_scale_per_ns=(log_scale_per_ns + occluder.log_scale_per_ns) / 2,
    )


def _is_within(sides: float, place: Similarity, last: LastDetection) -> bool:
    """Return whether a place is within a number of sides of the marker's last position."""
    return abs(place.centre_px - last.centre_px) <= sides * last.marker.side_px


def _located(
    pixels: Pixels, last: LastDetection, occluder: Occluder, passed_ns: int, min_correlation: float
) -> Similarity | None:
    """Register an occluder, starting from its predicted position, or else from the best match around it."""
    expected_px = occluder.place.centre_px + occluder.velocity_px_per_ns * passed_ns
    radius_sides = RADIUS_SIDES + SEARCH_SIDES + SEARCH_SIDES_PER_S2 * (passed_ns / SECOND_NS) ** 2 / 2
    crop = Crop.around(pixels, expected_px, radius_sides * last.marker.side_px, last.scale)
    if min(crop.levels.shape) < occluder.template.width_px:
        return None
    place = _registered(crop, occluder, crop.from_image(expected_px), passed_ns, min_correlation)
    if place is None:
        best_px = occluder.template.search(crop.levels)
        place = _registered(crop, occluder, best_px, passed_ns, MIN_STILL_CORRELATION)
    return place


def _registered(
    crop: Crop, occluder: Occluder, start_px: complex, passed_ns: int, min_correlation: float
) -> Similarity | None:
    """Register an occluder, starting at a point of a crop; None where it does not correlate or the scale is wrong."""
    start = Similarity(start_px, occluder.place.scale_rotation)
    in_crop, correlation = occluder.template.register(crop.levels, start)
    if correlation < min_correlation or not _has_plausible_scale(in_crop, occluder, passed_ns):
        return None
    return Similarity(crop.to_image(in_crop.centre_px), in_crop.scale_rotation)


def _has_plausible_scale(place: Similarity, occluder: Occluder, passed_ns: int) -> bool:
    error = _log_scale(place) - _log_scale(occluder.place) - occluder.log_scale_per_ns * passed_ns
    max_error = LOG_SCALE_NOISE + LOG_SCALE_PER_S2 * (passed_ns / SECOND_NS) ** 2 / 2
    return abs(_log_scale(place)) <= MAX_LOG_SCALE and abs(error) <= max_error


def _log_scale(place: Similarity) -> float:
    return math.log(abs(place.scale_rotation))


def _moved_with(marker: Marker, place: Similarity) -> Marker:
    """Move a marker's corners by the similarity of its occluder; the marker is hidden."""
    around = (marker.corners_px - marker.centre_px) @ [1, 1j]
    corners = place.centre_px + place.scale_rotation * around
    corners_px = np.stack([corners.real, corners.imag], axis=1)
    return replace(marker, corners_px=corners_px, covered=1.0, hidden=True, start=None)
