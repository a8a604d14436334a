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
        0,
        ge=0,
        description="which simulated person acts: each number has another body height, tempo and preferred hand",
    )
    seed: int = Field(
        1, ge=0, description="seed of the random variation between repetitions; the same seed gives the same movements"
    )
    repetitions: int = Field(
        0,
        ge=0,
        description="how often the simulated person does each action; 0 repeats them until the service is stopped",
    )
    image_hz: Annotated[Literal[0, 5, 10, 15, 30], BeforeValidator(_number)] = Field(
        15, description="colour images per second; 0 publishes no images (1/s)"
    )
    everyday: Choice = Field(
        "none",
        description=(
            "background activity between the actions, such as scratching: none; familiar (some kinds, for "
            "training); all (every kind, for tests); only (every kind, but no actions)"
        ),
    )
    minutes: float = Field(
        1.0,
        ge=0,
        description=(
            "minimum length of the scene; background activity fills the time after the last action. Without effect "
            "if --everyday is none (min)"
        ),
    )
    pauses: Pauses = Field(
        "long",
        description=(
            "what happens between two actions: long is up to three background activities and rests, short is at "
            "most one. Without effect if --everyday is none"
        ),
    )
    driven: bool = Field(
        False,
        description="let the simulated person stand still until the page or the command 'perform' asks for an action",
    )
    actors: int = Field(
        1,
        ge=1,
        le=MOST_PEOPLE,
        description="number of simulated people who act side by side; images are published only if it is 1",
    )
