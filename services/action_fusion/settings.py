"""Settings of the fusion."""

import re
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from actum import geometry
from actum.arrays import Array
from actum.settings import RememberingSettings

MATRIX_REMEDY = (
    "give the 16 numbers of a 4x4 matrix, row by row, in metres, or the name of a file that contains only these numbers"
)
MOST_CHARACTERS = 10_000
"""Characters read of a file: 16 numbers take 400 at most."""

FURTHEST_M = 1e6
"""Largest translation in metres: more is a mistake in the unit."""

SENSOR = "{sensor}"
"""Stands for the sensor in the name of a file, which is another one for each sensor."""

SEPARATORS = re.compile(r"[\s,;\[\]]+")
"""Separators between numbers, in lists as NumPy, JSON and MATLAB write them."""


def _transform_as_text(value: object) -> str | None:
    """Write a rigid transform as its 16 numbers; the value is a list of them, text that lists them, or a file's name.

    A name with `SENSOR` in it stays as it is until the sensor is known.

    Raises:
        ValueError: the value is no rigid transform, or the file cannot be read.
    """
    if value is None or (isinstance(value, str) and SENSOR in value):
        return value
    text = value if isinstance(value, str) else str(value)
    numbers = _numbers(text)
    if numbers is None:
        numbers = _numbers(_content(text))
    if numbers is None or len(numbers) != 16:
        raise ValueError(f"{text!r} is not a rigid transform: {MATRIX_REMEDY}")
    if not geometry.is_rigid(np.array(numbers).reshape(4, 4), FURTHEST_M):
        raise ValueError(
            f"{text!r} is not a rigid transform: the 4x4 matrix must consist of a rotation without scaling or "
            "mirroring, a position in metres, and 0 0 0 1 as the last row"
        )
    return " ".join(map(repr, numbers))


def _of_sensor(transform: str | None, sensor: str) -> str | None:
    """Write the transform of one sensor's camera as its 16 numbers.

    Raises:
        ValueError: there is none in the file of that sensor.
    """
    return None if transform is None else _transform_as_text(transform.replace(SENSOR, sensor))


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
        raise ValueError(
            f"{name!r} is neither a list of numbers nor a readable file ({error}): {MATRIX_REMEDY}"
        ) from None


class Settings(RememberingSettings):
    """Settings of the fusion, besides those of every service."""

    measure: Literal["joint", "proximity"] = Field(
        "joint",
        description=(
            "how to choose the object of an action. joint: the object that a hand holds, moves or reaches for. "
            "proximity: the object nearest to a hand"
        ),
    )
    reach_m: float = Field(
        0.25,
        gt=0,
        description=(
            "maximum distance (m) between a hand and the object of an action; pointing has no such maximum. For an "
            "object that moves during the action, the maximum is larger by the value of --grasp-m, because the person "
            "can move the object with a tool"
        ),
    )
    grasp_m: float = Field(
        0.20,
        gt=0,
        description=(
            "maximum distance between the centre of a hand and the centre of an object at which the hand counts as "
            "holding the object (m)"
        ),
    )
    moved_m: float = Field(0.03, gt=0, description="minimum displacement at which an object counts as moved (m)")
    pointing_labels: frozenset[str] = Field(
        frozenset({"point"}),
        description=(
            "labels of the actions in which a person points at an object, such as point,show. In these actions, the "
            "direction of the arm determines the object, at any distance"
        ),
    )
    pointing_limit_deg: float = Field(
        30.0,
        gt=0,
        lt=180,
        description=(
            "maximum angle between a pointing arm and the direction to the object (deg). If the angles to all objects "
            "are larger, the event names no object"
        ),
    )
    uncertainty_m: float = Field(
        0.02,
        ge=0,
        description=(
            "if a hand reaches towards several objects, and the distances between the hand and the objects differ by "
            "at most this value (m), the event lists these objects in the field 'candidates'"
        ),
    )
    pointing_uncertainty_deg: float = Field(
        2.0,
        ge=0,
        description=(
            "if a person points towards several objects, and the angles between the arm and the directions to the "
            "objects differ by at most this value (deg), the event lists these objects in the field 'candidates'"
        ),
    )
    expected_outcomes: dict[str, str] = Field(
        {"lift": "lifted", "put": "put down", "place": "put down", "push": "pushed", "pull": "pulled"},
        description=(
            "for each action, what is expected to happen to its object, such as lift=lifted,push=pushed. Events say "
            "whether this happened. In an action that is listed here, an object in the hand never counts as a tool. In "
            "any other action, it can; the event then names the object on which the person uses the tool"
        ),
    )
    world_from_camera: Annotated[str | None, BeforeValidator(_transform_as_text)] = Field(
        None,
        description=(
            "transform from camera coordinates to the coordinates of a room or robot. With this transform, events give "
            "object poses in both coordinate systems. Write the 16 numbers of a 4 x 4 matrix row by row (lengths in "
            "metres), or name a file that contains these numbers. For several sensors, store one file per sensor, and "
            "write {sensor} in place of the sensor's name, such as world-{sensor}.txt. Default: events give object "
            "poses in camera coordinates only"
        ),
    )
    world_frame: str = Field(
        "world",
        min_length=1,
        max_length=200,
        description=(
            "name of the coordinate system into which --world-from-camera transforms object poses; events contain this "
            "name"
        ),
    )

    @model_validator(mode="after")
    def _of_one_camera(self) -> Self:
        transform = self.world_from_camera
        if "," not in self.sensor:
            self.world_from_camera = _of_sensor(transform, self.sensor)
        elif transform is not None and SENSOR not in transform:
            raise ValueError(
                "world-from-camera gives the transform of one camera, but this process serves the sensors "
                f"{self.sensor}: store the transform of each camera in a file of its own, with the sensor's name in "
                "the file name, such as world-left.txt and world-right.txt. Then set world-from-camera to "
                f"world-{SENSOR}.txt and keep {SENSOR} as it is: the service replaces it by each sensor's name"
            )
        return self

    @property
    def of_each_sensor(self) -> list[Self]:
        """The settings for each of the sensors, with the transform of its own camera.

        Raises:
            ValueError: the file of a sensor holds no transform.
        """
        each = super().of_each_sensor
        transforms = [_of_sensor(own.world_from_camera, own.sensor) for own in each]
        return [
            own.model_copy(update={"world_from_camera": transform})
            for own, transform in zip(each, transforms, strict=True)
        ]

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
