"""What an image costs on one core, beside OpenCV's bare detection in the same run.

Eight markers go slowly over a cluttered 640x480 colour image, 60 times a second: all that the scene file names, or
all but one. They are large enough to be known by their edges, or so small that their whole pattern is aligned.
"""

import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from actum.images import gray
from actum.messages import Image
from marker_tracker.detection.families import family
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings

WIDTH, HEIGHT = 640, 480
FINE = 4
"""Drawn so many times as large: cells are even, and steps a quarter of a pixel."""
SIDES_PX, QUIET_PX = (56, 32), 8
MARKERS = 8
FRAMES, WARM_UP = 120, 10
SETS: tuple[tuple[str, ...], ...] = (
    ("DICT_4X4_50",),
    ("DICT_5X5_250",),
    ("DICT_APRILTAG_36H11",),
    ("DICT_4X4_50", "DICT_5X5_50"),
    ("DICT_5X5_50", "DICT_6X6_50"),
    ("DICT_4X4_50", "DICT_5X5_100"),
    ("DICT_4X4_50", "DICT_6X6_250", "DICT_APRILTAG_36H11"),
    ("DICT_4X4_50", "DICT_5X5_100", "DICT_APRILTAG_16H5", "DICT_APRILTAG_25H9", "DICT_APRILTAG_36H11"),
)


def speed() -> Iterator[str]:
    """Measure every size and choice of families."""
    yield "| families | px | bare detection, ms | tracker, ms | ratio | frames/s | one missing, ms | ratio | objects |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for side_px in SIDES_PX:
        for names in SETS:
            yield row(names, side_px)


def row(names: Sequence[str], side_px: int) -> str:
    frames = [frame(names, side_px, shift) for shift in range(FRAMES)]
    trackers = [MarkerTracker(Settings(scene=scene(names, count))) for count in (MARKERS, MARKERS + 1)]
    bare = cv2.aruco.ArucoDetector([family(name).dictionary for name in names], cv2.aruco.DetectorParameters())
    greys = [gray(image) for image in frames]
    seen: list[int] = []

    def track(tracker: MarkerTracker) -> Callable[[int], None]:
        def step(i: int) -> None:
            (answer,) = tracker.handle(frames[i])
            seen.append(sum(found.seen for found in answer.objects))  # type: ignore[attr-defined]

        return step

    steps = [lambda i: bare.detectMarkersMultiDict(greys[i]), *map(track, trackers)]
    bare_ms, all_ms, missing_ms = (1e3 * statistics.mean(times[WARM_UP:]) for times in timed(steps))
    listed = ", ".join(name.removeprefix("DICT_") for name in names)
    return (
        f"| {listed} | {side_px} | {bare_ms:.1f} | {all_ms:.1f} | {all_ms / bare_ms:.2f} | {1e3 / all_ms:.0f} "
        f"| {missing_ms:.1f} | {missing_ms / bare_ms:.2f} | {min(seen)} |"
    )


def timed(steps: Sequence[Callable[[int], Any]]) -> list[list[float]]:
    """Take each step in turn for each frame, so that whatever else the machine does falls on all of them."""
    times: list[list[float]] = [[] for _ in steps]
    for i in range(FRAMES):
        for step, taken in zip(steps, times, strict=True):
            start = time.process_time()
            step(i)
            taken.append(time.process_time() - start)
    return times


def scene(names: Sequence[str], count: int) -> Path:
    lines = [f"  {i}: {{name: o{i}, family: {names[i % len(names)]}, markers: [{{id: {i}}}]}}" for i in range(count)]
    path = Path(tempfile.mkdtemp()) / "objects.yaml"
    path.write_text("size_m: 0.08\nobjects:\n" + "\n".join(lines) + "\n")
    return path


def frame(names: Sequence[str], side_px: int, shift: int) -> Image:
    """Draw eight markers, a part of a pixel further on in each frame, over grey rectangles, blurred and with noise."""
    chance = np.random.default_rng(0)
    fine = np.full((FINE * HEIGHT, FINE * WIDTH), 120, dtype=np.uint8)
    for _ in range(60):
        box = FINE * chance.integers((0, 0, 8, 8), (WIDTH, HEIGHT, 90, 90))
        cv2.rectangle(fine, [int(v) for v in box], int(chance.integers(40, 220)), -1)
    for i in range(MARKERS):
        x, y = FINE * (30 + 150 * (i % 4)) + shift, FINE * (90 + 210 * (i // 4)) + 2 * shift // 3
        drawn = cv2.aruco.generateImageMarker(family(names[i % len(names)]).dictionary, i, FINE * side_px)
        sheet = np.pad(np.maximum(drawn, 25), FINE * QUIET_PX, constant_values=235)
        fine[y : y + len(sheet), x : x + len(sheet)] = sheet
    canvas = cv2.GaussianBlur(cv2.resize(fine, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA), (0, 0), 0.7)
    noisy = canvas + np.random.default_rng(shift).normal(0, 2, canvas.shape)
    bgr = cv2.cvtColor(np.clip(noisy, 0, 255).astype(np.uint8), cv2.COLOR_GRAY2BGR)
    return Image(
        stamp_ns=shift * 16_666_667, sensor="kinect0", format="bgr8", width=WIDTH, height=HEIGHT, data=bgr.tobytes(),
        K=[525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0], distortion=[],
        skeleton_from_image=np.eye(4).ravel().tolist(),
    )  # fmt: skip
