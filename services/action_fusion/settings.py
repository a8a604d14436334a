"""Settings of the fusion."""

import math

from pydantic import Field, FiniteFloat, field_validator

from actum.settings import ServiceSettings

Direction = tuple[FiniteFloat, FiniteFloat, FiniteFloat]


class Settings(ServiceSettings):
    """What the fusion can be told beside what every service can."""

    reach_m: float = Field(
        0.25, gt=0, description="an object whose marker never came this near to the hand was not reached"
    )
    moved_m: float = Field(0.03, gt=0, description="an object displaced by less has not moved")
    pointing_labels: frozenset[str] = Field(
        frozenset({"point"}), description="actions whose object is where the arm points to, near or not"
    )
    pointing_limit_deg: float = Field(
        30.0, gt=0, lt=180, description="an object further than this from the line of the arm is not pointed at"
    )
    up_in_camera: Direction = Field((0.0, -1.0, 0.0), description="against gravity, in the camera's frame")

    @field_validator("up_in_camera")
    @classmethod
    def _is_direction(cls, up: Direction) -> Direction:
        if math.hypot(*up) < 1e-3:
            raise ValueError("up_in_camera has no direction: [0, -1, 0] is up for a level camera")
        return up
