"""The scenes that corners are measured in: markers of one family and size that drift before a cluttered wall."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from marker_tracker.detection.families import family as family_of

from .rendering import Pixels, Placed, Print, photograph, placed

FIRST_SEED = 9000
"""Seeds from here on had no part in the making of the tracker."""
IMAGES, HZ = 5, 60
COLUMNS, ROWS, CELL_PX = 4, 3, 160
"""Markers of an image, each within a cell of its own."""
JITTER_PX = 15.0
FASTEST_PX = 1.0
"""Drift from one image to the next, at most: 0.6 m/s at 5 m, 0.1 m/s at 1 m."""
INK, PAPER = (20.0, 50.0), (140.0, 235.0)


@dataclass(frozen=True)
class Condition:
    """How markers are seen: how steep (least and most, in degrees), with what blur, noise, paper, wall and light."""

    steep_deg: tuple[float, float] = (0.0, 40.0)
    blur_px: float = 0.7
    noise: float = 2.0
    quiet_cells: float = 1.0
    wall: float = 120.0
    shaded: bool = False


CONDITIONS: Mapping[str, Condition] = {
    "plain": Condition(),
    "steep": Condition(steep_deg=(50.0, 75.0)),
    "blurred": Condition(blur_px=1.4),
    "noisy": Condition(noise=8.0),
    "cut out": Condition(quiet_cells=0.5, wall=30.0),
    "half in shadow": Condition(shaded=True),
}


@dataclass(frozen=True)
class Scene:
    """A sequence of images of twelve markers; the same numbers, the same scene."""

    family: str
    side_px: int
    condition: str
    seed: int

    @cached_property
    def truth(self) -> list[list[Placed]]:
        """Where the markers of each image are."""
        chance = np.random.default_rng((FIRST_SEED, self.seed))
        ids = chance.choice(len(family_of(self.family).codes), COLUMNS * ROWS, replace=False)
        sequences = [self._drifting(chance, int(number), cell) for cell, number in enumerate(ids)]
        return [list(image) for image in zip(*sequences, strict=True)]

    @cached_property
    def images(self) -> list[Pixels]:
        """The images, with the same wall and noise of their own."""
        look = CONDITIONS[self.condition]
        return [
            photograph(markers, look.blur_px, look.noise, look.wall, look.shaded, FIRST_SEED + self.seed, number)
            for number, markers in enumerate(self.truth)
        ]

    def _drifting(self, chance: np.random.Generator, number: int, cell: int) -> list[Placed]:
        look = CONDITIONS[self.condition]
        printed = Print(self.family, number, chance.uniform(*INK), chance.uniform(*PAPER), look.quiet_cells)
        steep_rad, (turn_rad, axis_rad) = np.radians(chance.uniform(*look.steep_deg)), chance.uniform(0, 2 * np.pi, 2)
        middle_px = CELL_PX * (np.array([cell % COLUMNS, cell // COLUMNS]) + 0.5)
        start_px, drift_px = middle_px + chance.uniform(-JITTER_PX, JITTER_PX, 2), chance.uniform(-1, 1, 2)
        step_px = FASTEST_PX * drift_px / max(1.0, float(np.linalg.norm(drift_px)))
        return [
            placed(printed, start_px + i * step_px, self.side_px, steep_rad, turn_rad, axis_rad) for i in range(IMAGES)
        ]
