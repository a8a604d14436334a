"""How exact corners and distances are, and how many markers are found, by size, condition and family."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.marker import Marker
from marker_tracker.pose.camera_model import CameraModel
from marker_tracker.pose.catalogue import MountedMarker
from marker_tracker.pose.poses import BadPoseError, solve

from .marker_scenes import CONDITIONS, HZ, Scene
from .rendering import CAMERA, SIZE_M, Placed
from .rows import ROWS, Row

Array = NDArray[np.float64]

SIDES_PX = (12, 16, 20, 24, 32, 40, 60)
FAMILIES = ("DICT_4X4_50", "DICT_5X5_250", "DICT_6X6_250", "DICT_APRILTAG_36H11")
SAME_PLACE, SAME_PLACE_PX = 0.2, 2.0
"""A marker is found where no corner is further off than this part of its side, or so many pixels; else it is wrong."""
DRAWS = 1000
"""Of scenes with replacement, for the intervals."""
VIEW = CameraModel(CAMERA, np.zeros(0), np.eye(4))


@dataclass(frozen=True)
class Measured:
    """A row's markers in all scenes, (scenes, images x markers) each, and what they took.

    `off_px2` is the mean square of a marker's corners, `distance_off` the error of its distance in parts of it, both
    NaN where it was not found; `wrong` (scenes,) counts markers of other ids or in other places.
    """

    off_px2: Array
    distance_off: Array
    wrong: Array
    ms: float

    @property
    def found(self) -> NDArray[np.bool_]:
        return np.isfinite(self.off_px2)


def accuracy() -> Iterator[str]:
    """Measure all rows in the same scenes."""
    scenes = [
        Scene(family, side_px, condition, number)
        for number, (family, side_px, condition) in enumerate(
            (family, side_px, condition) for family in FAMILIES for side_px in SIDES_PX for condition in CONDITIONS
        )
    ]
    measured = _measured(scenes)
    yield from _summary(measured)
    groups: Mapping[str, Sequence[object]] = {"side_px": SIDES_PX, "condition": [*CONDITIONS], "family": FAMILIES}
    for by, values in groups.items():
        chosen = {str(value): np.array([getattr(scene, by) == value for scene in scenes]) for value in values}
        for title, number in NUMBERS.items():
            yield from _table(f"{title}, by {by.removesuffix('_px')}", measured, chosen, number)


def _measured(scenes: Sequence[Scene]) -> dict[str, Measured]:
    """Let every row look at each scene in turn, so that whatever else the machine does falls on all of them."""
    parts: dict[str, list[tuple[Array, Array, int, float]]] = {name: [] for name in ROWS}
    for scene in scenes:
        for name, row in ROWS.items():
            parts[name].append(_looked_at(scene, row))
        del scene.__dict__["images"]
    return {
        name: Measured(
            np.stack([off for off, _, _, _ in of_row]),
            np.stack([distance for _, distance, _, _ in of_row]),
            np.array([wrong for _, _, wrong, _ in of_row], dtype=float),
            1e3 * float(np.mean([seconds for _, _, _, seconds in of_row])),
        )
        for name, of_row in parts.items()
    }


def _looked_at(scene: Scene, row: Row) -> tuple[Array, Array, int, float]:
    """Find the markers of a scene: errors (images x markers,) twice, how many are wrong, and seconds for an image."""
    off, wrong, seconds = [], 0, 0.0
    with row.running(scene.family, [marker.printed.id for marker in scene.truth[0]]) as detect:
        for number, (pixels, truth) in enumerate(zip(scene.images, scene.truth, strict=True)):
            began = time.process_time()
            found = detect(number * 1_000_000_000 // HZ, pixels)
            seconds += time.process_time() - began
            errors = [_error(found, marker) for marker in truth]
            off += errors
            wrong += len(found) - sum(np.isfinite(px2) for px2, _ in errors)
    off_px2, distance_off = np.array(off).T
    return off_px2, distance_off, wrong, seconds / len(scene.images)


def _error(found: Sequence[Marker], truth: Placed) -> tuple[float, float]:
    """Mean square error of a marker's corners in px², and of its distance in parts of it; NaN where it is not found."""
    corners_px = truth.corners_px
    side_px = np.linalg.norm(corners_px - np.roll(corners_px, 1, axis=0), axis=1).max()
    for marker in found:
        off_px = np.linalg.norm(marker.corners_px - corners_px, axis=1)
        if marker.id == truth.printed.id and off_px.max() <= max(SAME_PLACE_PX, SAME_PLACE * side_px):
            return float((off_px**2).mean()), _distance_m(marker) / truth.distance_m - 1
    return np.nan, np.nan


def _distance_m(marker: Marker) -> float:
    try:
        pose = solve([(marker, MountedMarker(0, SIZE_M))], VIEW)[0]
    except BadPoseError:
        return np.nan
    return float(np.linalg.norm(pose.camera_from_object[:3, 3]))


def _summary(measured: Mapping[str, Measured]) -> Iterator[str]:
    everywhere = np.ones(len(next(iter(measured.values())).wrong), dtype=bool)
    common = _common(measured)
    yield "Over all scenes:\n"
    yield "| | found, % | wrong | corner rms, px | distance bias, % | distance rms, % | ms an image |"
    yield "|---|---|---|---|---|---|---|"
    for name, row in measured.items():
        numbers = [number(row, common, everywhere) for number in NUMBERS.values()]
        scatter = _with_interval(row.distance_off**2, common, everywhere, lambda mean: 100 * np.sqrt(mean))
        found, corners, bias = numbers
        yield f"| {name} | {found} | {row.wrong.sum():.0f} | {corners} | {bias} | {scatter} | {row.ms:.1f} |"
    yield f"\nMarkers that all rows found, by which corners and distances are compared: {common.mean():.0%}."


def _table(
    title: str,
    measured: Mapping[str, Measured],
    chosen: Mapping[str, NDArray[np.bool_]],
    number: Callable[[Measured, NDArray[np.bool_], NDArray[np.bool_]], str],
) -> Iterator[str]:
    common = _common(measured)
    yield f"\n{title}:\n"
    yield f"| | {' | '.join(chosen)} |"
    yield "|---" * (len(chosen) + 1) + "|"
    for name, row in measured.items():
        yield f"| {name} | {' | '.join(number(row, common, scenes) for scenes in chosen.values())} |"


def _common(measured: Mapping[str, Measured]) -> NDArray[np.bool_]:
    """Tell which markers all rows found."""
    return np.logical_and.reduce([row.found for row in measured.values()])


def _found(row: Measured, _common: NDArray[np.bool_], scenes: NDArray[np.bool_]) -> str:
    return _with_interval(row.found.astype(float), np.ones_like(row.found), scenes, lambda mean: 100 * mean, 0)


def _corner_rms(row: Measured, common: NDArray[np.bool_], scenes: NDArray[np.bool_]) -> str:
    return _with_interval(row.off_px2, common, scenes, np.sqrt)


def _distance_bias(row: Measured, common: NDArray[np.bool_], scenes: NDArray[np.bool_]) -> str:
    return _with_interval(row.distance_off, common, scenes, lambda mean: 100 * mean)


NUMBERS: Mapping[str, Callable[[Measured, NDArray[np.bool_], NDArray[np.bool_]], str]] = {
    "Found, %": _found,
    "Corner rms, px": _corner_rms,
    "Distance bias, %": _distance_bias,
}


def _with_interval(
    values: Array,
    counted: NDArray[np.bool_],
    scenes: NDArray[np.bool_],
    shown: Callable[[Array], Array],
    digits: int = 2,
) -> str:
    """Mean of the values that count in the chosen scenes, and half its 95 % interval over draws of scenes."""
    counted = (counted & np.isfinite(values))[scenes]
    sums, counts = np.where(counted, values[scenes], 0.0).sum(axis=1), counted.sum(axis=1)
    if not counts.any():
        return "-"
    number = len(sums)
    draws = np.random.default_rng(0).multinomial(number, np.full(number, 1 / number), DRAWS)
    usable = draws[draws @ counts > 0]
    low, high = np.quantile(shown((usable @ sums) / (usable @ counts)), (0.025, 0.975))
    middle = shown(sums.sum() / counts.sum())
    return f"{middle:.{digits}f} ± {(high - low) / 2:.{digits}f}"
