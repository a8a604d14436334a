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

    actor: int = Field(
        0, ge=0, description="number of the simulated person, who has a height, a tempo and a handedness"
    )
    seed: int = Field(1, ge=0, description="seed of the random variation between repetitions")
    repetitions: int = Field(0, ge=0, description="how often the simulated person does each action; 0: without end")
    image_hz: Annotated[Literal[0, 5, 10, 15, 30], BeforeValidator(_number)] = Field(
        15, description="colour images per second; 0 publishes none"
    )
    everyday: Choice = Field("none", description="everyday activities between the actions; only: no actions at all")
    minutes: float = Field(
        1.0, ge=0, description="least length of a scene with everyday activities, which fill the remaining time (min)"
    )
    pauses: Pauses = Field(
        "long",
        description="pauses between actions; long: up to three everyday activities and rests; short: at most one",
    )
    driven: bool = Field(False, description="stand still until the command 'perform' asks for an action")
    actors: int = Field(
        1, ge=1, le=MOST_PEOPLE, description="people who act side by side; more than one publishes no images"
    )
