"""Settings of the sensor gateway."""

from pathlib import Path
from typing import Literal

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """What the gateway can be told beside what every service can."""

    source: Literal["simulator", "recording", "msr-action3d", "utkinect"] = Field(
        "simulator", description="where the frames come from"
    )
    path: Path | None = Field(None, description="the recording or data set: a file, or a folder played in order")
    actor: int = Field(0, ge=0, description="simulator: who acts")
    seed: int = Field(1, ge=0, description="simulator: which repetitions")
    repetitions: int = Field(0, ge=0, description="simulator: how often each action is done; 0 goes on for ever")
    image_hz: Literal[0, 5, 10, 15, 30] = Field(15, description="simulator: colour images a second; 0 for none")
    calibration: Path | None = Field(
        None, description="a file of `actum calibrate`: where given, its camera is put with each colour image"
    )
