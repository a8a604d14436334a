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
        description="joint: closeness, the reach and moving together, over the segment; proximity: the paper's smallest"
        " distance",
    )
    reach_m: float = Field(
        0.25, gt=0, description="an object whose marker never came this near to the hand was not reached"
    )
    grasp_m: float = Field(
        0.20,
        gt=0,
        description="an object may be in a hand up to this distance of their centres: a decimetre from the palm to the"
        " fingertips, and half of a thing of two decimetres",
    )
    moved_m: float = Field(0.03, gt=0, description="an object displaced by less has not moved")
    pointing_labels: frozenset[str] = Field(
        frozenset({"point"}), description="actions whose object is where the arm points to, near or not"
    )
    pointing_limit_deg: float = Field(
        30.0, gt=0, lt=180, description="an object further than this from the line of the arm is not pointed at"
    )
    uncertainty_m: float = Field(
        0.02, ge=0, description="objects that the hand missed by amounts this close are both named"
    )
    pointing_uncertainty_deg: float = Field(
        2.0, ge=0, description="objects whose angles to the line of the arm are this close are both named"
    )
    expected_outcomes: dict[str, str] = Field(
        {"lift": "lifted", "put": "put down", "place": "put down", "push": "pushed", "pull": "pulled"},
        description="what an action is to do to its object; it applies no held thing to another",
    )
    world_from_camera: Annotated[str | None, BeforeValidator(as_text)] = Field(
        None,
        description="maps the skeletons' camera frame to a fixed one, in which events then also give the object's pose:"
        " 16 numbers, row-major, or a file of them",
    )
    world_frame: str = Field("world", min_length=1, max_length=200, description="what events call that fixed frame")

    @property
    def fixed_from_camera(self) -> Array | None:
        """`world_from_camera` as an array (4, 4); None where it is not set."""
        return None if self.world_from_camera is None else from_text(self.world_from_camera)

    @property
    def reach_with_tool_m(self) -> float:
        """Largest distance from a hand that a tool in it reaches (m); the tool may have no marker."""
        return self.reach_m + self.grasp_m
