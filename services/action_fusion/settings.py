"""Settings of the fusion."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from action_fusion.fixed_frame import as_text, from_text
from actum.arrays import Array
from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """Settings of the fusion, besides those of every service."""

    measure: Literal["joint", "proximity"] = Field(
        "joint",
        description=(
            "how to choose the object: joint weighs closeness, reach and common motion over the segment; "
            "proximity takes the smallest distance, as the paper does"
        ),
    )
    reach_m: float = Field(
        0.25,
        gt=0,
        description="greatest distance between a hand and the marker of an object that it can reach (m)",
    )
    grasp_m: float = Field(
        0.20,
        gt=0,
        description="greatest distance between the centres of a hand and of an object that it can hold (m)",
    )
    moved_m: float = Field(0.03, gt=0, description="least displacement at which an object counts as moved (m)")
    pointing_labels: frozenset[str] = Field(
        frozenset({"point"}), description="actions whose object is the one that the arm points to, at any distance"
    )
    pointing_limit_deg: float = Field(
        30.0,
        gt=0,
        lt=180,
        description="greatest angle between the arm and the direction to an object that it points to (deg)",
    )
    uncertainty_m: float = Field(
        0.02, ge=0, description="difference of two objects' distances to the hand below which an event names both (m)"
    )
    pointing_uncertainty_deg: float = Field(
        2.0, ge=0, description="an event names two objects if their angles to the pointing arm differ by less (deg)"
    )
    expected_outcomes: dict[str, str] = Field(
        {"lift": "lifted", "put": "put down", "place": "put down", "push": "pushed", "pull": "pulled"},
        description="expected result of each action on its object; for these actions a held object is never the tool",
    )
    world_from_camera: Annotated[str | None, BeforeValidator(as_text)] = Field(
        None,
        description=(
            "rigid transform from the skeletons' camera frame to a fixed frame, in which events then give the "
            "object's pose as well: 16 numbers, row-major, or a file of them"
        ),
    )
    world_frame: str = Field("world", min_length=1, max_length=200, description="name of that fixed frame in events")

    @property
    def fixed_from_camera(self) -> Array | None:
        """`world_from_camera` as an array (4, 4); None where it is not set."""
        return None if self.world_from_camera is None else from_text(self.world_from_camera)

    @property
    def reach_with_tool_m(self) -> float:
        """Largest distance from a hand that a tool in it reaches (m); the tool may have no marker."""
        return self.reach_m + self.grasp_m
