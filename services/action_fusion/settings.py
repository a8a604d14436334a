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
    world_from_camera: Annotated[str | None, BeforeValidator(as_text)] = Field(
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
        return None if self.world_from_camera is None else from_text(self.world_from_camera)

    @property
    def reach_with_tool_m(self) -> float:
        """Largest distance from a hand that a tool in it reaches (m); the tool may have no marker."""
        return self.reach_m + self.grasp_m
