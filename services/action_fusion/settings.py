"""Settings of the fusion."""

import re
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from actum import geometry
from actum.arrays import Array
from actum.settings import ServiceSettings

FORM = "a rigid transform: give the 16 numbers of a 4x4 matrix, row by row, in metres, or a file that holds only them"
MOST_CHARACTERS = 10_000
"""Characters read of a file: 16 numbers take 400 at most."""

FURTHEST_M = 1e6
"""Largest translation in metres: more is a mistake in the unit."""

SEPARATORS = re.compile(r"[\s,;\[\]]+")
"""Separators between numbers, in lists as NumPy, JSON and MATLAB write them."""


def _transform_as_text(value: object) -> str | None:
    """Write a rigid transform as its 16 numbers; the value is a list of them, text that lists them, or a file's name.

    Raises:
        ValueError: the value is no rigid transform, or the file cannot be read.
    """
    if value is None:
        return None
    text = value if isinstance(value, str) else str(value)
    numbers = _numbers(text)
    if numbers is None:
        numbers = _numbers(_content(text))
    if numbers is None or len(numbers) != 16:
        raise ValueError(f"{text!r} is not {FORM}")
    if not geometry.is_rigid(np.array(numbers).reshape(4, 4), FURTHEST_M):
        raise ValueError(
            f"{text!r} is not a rigid transform: give a rotation, a position in metres, and 0 0 0 1 as the last row"
        )
    return " ".join(map(repr, numbers))


def _numbers(text: str) -> list[float] | None:
    """Read the numbers that a text lists; None where it lists anything else."""
    try:
        return [float(word) for word in SEPARATORS.split(text) if word]
    except ValueError:
        return None


def _content(name: str) -> str:
    try:
        with Path(name).open(encoding="utf-8") as file:
            return file.read(MOST_CHARACTERS)
    except (OSError, ValueError) as error:
        raise ValueError(f"{name!r} is not {FORM} ({error})") from None


class Settings(ServiceSettings):
    """Settings of the fusion, besides those of every service."""

    measure: Literal["joint", "proximity"] = Field(
        "joint",
        description=(
            "how to choose the object of an action: joint uses how near each object is to the hands, whether a hand "
            "reaches for it, and whether it moves with a hand; proximity chooses the object nearest to a hand"
        ),
    )
    reach_m: float = Field(
        0.25,
        gt=0,
        description=(
            "maximum distance from a hand to the marker of an object that the hand can reach; if the hand may hold "
            "a tool, --grasp-m is added (m)"
        ),
    )
    grasp_m: float = Field(
        0.20, gt=0, description="maximum distance between the centres of a hand and an object that counts as held (m)"
    )
    moved_m: float = Field(0.03, gt=0, description="minimum displacement of an object that counts as moved (m)")
    pointing_labels: frozenset[str] = Field(
        frozenset({"point"}), description="actions that point at their object, at any distance, such as point,show"
    )
    pointing_limit_deg: float = Field(
        30.0,
        gt=0,
        lt=180,
        description=(
            "maximum angle between the pointing arm and the direction to an object that counts as pointed at (deg)"
        ),
    )
    uncertainty_m: float = Field(
        0.02,
        ge=0,
        description="an event names two possible objects if their distances to the hand differ by less than this (m)",
    )
    pointing_uncertainty_deg: float = Field(
        2.0,
        ge=0,
        description="an event names two possible objects if their angles to the arm differ by less than this (deg)",
    )
    expected_outcomes: dict[str, str] = Field(
        {"lift": "lifted", "put": "put down", "place": "put down", "push": "pushed", "pull": "pulled"},
        description=(
            "the result expected of each action, such as lift=lifted,push=pushed; an object held during one of these "
            "actions is the object of that action, not a tool"
        ),
    )
    world_from_camera: Annotated[str | None, BeforeValidator(_transform_as_text)] = Field(
        None,
        description=(
            "transform from camera coordinates to those of a room or robot: the 16 numbers of a 4 x 4 matrix, row by "
            "row, lengths in metres, or a file with these numbers. Events then give object poses in both coordinate "
            "systems. Default: camera coordinates only"
        ),
    )
    world_frame: str = Field(
        "world",
        min_length=1,
        max_length=200,
        description="name that events use for the frame to which --world-from-camera transforms",
    )

    @property
    def fixed_from_camera(self) -> Array | None:
        """`world_from_camera` as an array (4, 4); None where it is not set."""
        if self.world_from_camera is None:
            return None
        return geometry.from_flat([float(number) for number in self.world_from_camera.split()])

    @property
    def reach_with_tool_m(self) -> float:
        """Largest distance from a hand that a tool in it reaches (m); the tool may have no marker."""
        return self.reach_m + self.grasp_m
