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
            "how to decide which object an action was done to: joint weighs distance, reaching and moving together; "
            "proximity takes the object nearest to a hand"
        ),
    )
    reach_m: float = Field(
        0.25,
        gt=0,
        description=(
            "maximum distance between a hand and the marker of an object that it can reach; a tool in the hand adds "
            "--grasp-m (m)"
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
            "maximum angle between the pointing arm and the direction to an object; other objects are not pointed "
            "at (deg)"
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
            "what each action does to its object, such as lift=lifted,push=pushed; an object that is held during "
            "these actions is their object, not a tool"
        ),
    )
    world_from_camera: Annotated[str | None, BeforeValidator(as_text)] = Field(
        None,
        description=(
            "transform from camera coordinates to those of a room or robot: a 4 x 4 matrix as 16 numbers, row by "
            "row, or a file of them. Events then give object poses in both. Default: camera coordinates only"
        ),
    )
    world_frame: str = Field(
        "world",
        min_length=1,
        max_length=200,
        description="name in events of the frame that --world-from-camera transforms to",
    )

    @property
    def fixed_from_camera(self) -> Array | None:
        """`world_from_camera` as an array (4, 4); None where it is not set."""
        return None if self.world_from_camera is None else from_text(self.world_from_camera)

    @property
    def reach_with_tool_m(self) -> float:
        """Largest distance from a hand that a tool in it reaches (m); the tool may have no marker."""
        return self.reach_m + self.grasp_m
