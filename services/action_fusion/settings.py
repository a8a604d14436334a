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
            "how to choose the object of an action: joint considers how near each object is to the hands, whether a "
            "hand reaches for the object, and whether the object moves with a hand; proximity chooses the object "
            "nearest to a hand"
        ),
    )
    reach_m: float = Field(
        0.25,
        gt=0,
        description=(
            "an object is within reach of a hand if its marker is at most this many metres from the hand; if the hand "
            "may hold a tool, --grasp-m is added to this distance"
        ),
    )
    grasp_m: float = Field(
        0.20,
        gt=0,
        description=(
            "an object can count as held only if its centre is at most this many metres from the centre of the hand"
        ),
    )
    moved_m: float = Field(
        0.03, gt=0, description="an object counts as moved if it is displaced by at least this many metres"
    )
    pointing_labels: frozenset[str] = Field(
        frozenset({"point"}),
        description=(
            "actions in which the person points at the object, such as point,show. For these actions the object is the "
            "one in the direction of the arm, however far away it is"
        ),
    )
    pointing_limit_deg: float = Field(
        30.0,
        gt=0,
        lt=180,
        description=(
            "an object counts as pointed at only if the angle between the pointing arm and the direction to the object "
            "is at most this many degrees"
        ),
    )
    uncertainty_m: float = Field(
        0.02,
        ge=0,
        description=(
            "an event names several possible objects if the hand is almost equally near to all of them: their "
            "distances to the hand differ by at most this many metres"
        ),
    )
    pointing_uncertainty_deg: float = Field(
        2.0,
        ge=0,
        description=(
            "an event also names an object as possible if its angle from the pointing arm is at most this many degrees "
            "larger than that of the best object"
        ),
    )
    expected_outcomes: dict[str, str] = Field(
        {"lift": "lifted", "put": "put down", "place": "put down", "push": "pushed", "pull": "pulled"},
        description=(
            "the result that each action should have on its object, such as lift=lifted,push=pushed. In these actions, "
            "a held object is never seen as a tool; in all other actions, it can be a tool used on another object"
        ),
    )
    world_from_camera: Annotated[str | None, BeforeValidator(_transform_as_text)] = Field(
        None,
        description=(
            "transform from the coordinates of the camera to those of a room or robot: the 16 numbers of a 4 x 4 "
            "matrix, row by row, lengths in metres, or a file with these numbers. For several sensors, write {sensor} "
            "in place of the sensor's name in the name of the file, such as world-{sensor}.txt. Events then give "
            "object poses in both coordinate systems. Default: events give object poses in camera coordinates only"
        ),
    )
    world_frame: str = Field(
        "world",
        min_length=1,
        max_length=200,
        description="name of the coordinate system to which --world-from-camera transforms, as it appears in events",
    )

    @model_validator(mode="after")
    def _of_one_camera(self) -> Self:
        transform = self.world_from_camera
        if "," not in self.sensor:
            self.world_from_camera = _of_sensor(transform, self.sensor)
        elif transform is not None and SENSOR not in transform:
            raise ValueError(
                "world-from-camera is the transform of one camera, but this process serves the sensors "
                f"{self.sensor}: store the transform of each camera in a file of its own, and set world-from-camera "
                f"to the files' common name, with {SENSOR} in place of the sensor's name, such as world-{SENSOR}.txt"
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
