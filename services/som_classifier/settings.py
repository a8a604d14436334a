"""Settings of the classifier."""

from pathlib import Path

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """What the classifier can be told beside what every service can."""

    model: Path | None = Field(None, description="the model file; it may appear or change at any time")
    publish_maps: bool = Field(False, description="put the maps' activities and the trace with each final action")
