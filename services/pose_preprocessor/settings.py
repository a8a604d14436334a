"""Settings of the pose preprocessor."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """What the preprocessor can be told beside what every service can."""

    reach_limit_m: float = Field(
        10.0,
        gt=0,
        le=1000,
        description="maximum distance of a joint from the camera; frames that exceed it are rejected (m)",
    )
    bone_limit_m: float = Field(
        1.5,
        gt=0,
        le=1000,
        description="maximum length of a bone between two joints; frames that exceed it are rejected (m)",
    )

    @classmethod
    def defaults(cls) -> "Settings":
        """Return the default values without reading the environment or a file, so that results can be reproduced."""
        return cls.model_construct()
