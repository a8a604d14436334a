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
        description=(
            "number (0 or higher) that selects the simulated person. The body height, the tempo and the preferred hand "
            "of the person depend on this number"
        ),
    )
    seed: int = Field(
        1, ge=0, description="seed of the random variation between repetitions; the same seed gives the same movements"
    )
    repetitions: int = Field(
        0,
        ge=0,
        description=(
            "number of times that the simulated person does each action; 0 repeats the actions until the service is "
            "stopped"
        ),
    )
    image_hz: Annotated[Literal[0, 5, 10, 15, 30], BeforeValidator(_number)] = Field(
        15, description="number of colour images published per second; 0 publishes no images"
    )
    everyday: Choice = Field(
        "none",
        description=(
            "which background activities, such as scratching, the simulated person does between the actions. none: no "
            "background activities. familiar: some kinds, to train a model with. all: all kinds, to test a model with. "
            "only: all kinds, and no actions at all"
        ),
    )
    minutes: float = Field(
        1.0,
        ge=0,
        description=(
            "minimum length of the scene, in minutes. If the actions end earlier, background activities (see "
            "--everyday) fill the remaining time. Ignored if --everyday is none"
        ),
    )
    pauses: Pauses = Field(
        "long",
        description=(
            "what the simulated person does between two actions. long: up to three background activities, and rests of "
            "several seconds. short: at most one background activity, and short rests. Ignored if --everyday is none"
        ),
    )
    driven: bool = Field(
        False,
        description=(
            "let the simulated person act only on request, and stand still otherwise. Request actions on the web page "
            "or with the Zenoh query 'perform'"
        ),
    )
    actors: int = Field(
        1,
        ge=1,
        le=MOST_PEOPLE,
        description=(
            "number of simulated people who act side by side. With more than one person, no images are published"
        ),
    )
