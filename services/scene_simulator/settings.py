"""Settings of the simulated scene."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from actum.settings import ServiceSettings
from scene_simulator.everyday import Choice, Pauses
from scene_simulator.group import MOST_PEOPLE


def _number(text: object) -> object:
    return int(text) if isinstance(text, str) and text.isdecimal() else text


class Settings(ServiceSettings):
    """The simulated scene's settings, beside those of every service."""

    actor: int = Field(0, ge=0, description="who acts")
    seed: int = Field(1, ge=0, description="which repetitions")
    repetitions: int = Field(0, ge=0, description="how often each action is done; 0 goes on for ever")
    image_hz: Annotated[Literal[0, 5, 10, 15, 30], BeforeValidator(_number)] = Field(
        15, description="colour images a second; 0 for none"
    )
    everyday: Choice = Field("none", description="what people do between actions; only: nothing else")
    minutes: float = Field(1.0, ge=0, description="least length of a scene with everyday doings, which fill it up")
    pauses: Pauses = Field("long", description="between actions up to three everyday doings and rests, or at most one")
    driven: bool = Field(False, description="the person stands still until asked to perform, see the command 'perform'")
    actors: int = Field(1, ge=1, le=MOST_PEOPLE, description="how many act side by side; several have no images")
