"""Settings of the pose preprocessor."""

from pydantic import Field

from actum.settings import SharedSettings


class Settings(SharedSettings):
    """Settings of the preprocessor, beside those of every service."""

    reach_limit_m: float = Field(
        10.0,
        gt=0,
        le=1000,
        description=(
            "maximum distance of a joint from the camera along each coordinate axis (m); a person is ignored in frames "
            "in which a joint is farther away"
        ),
    )
    bone_limit_m: float = Field(
        1.5,
        gt=0,
        le=1000,
        description=(
            "maximum length of a bone between two joints (m); a person is ignored in frames in which a bone is longer"
        ),
    )

    @classmethod
    def defaults(cls) -> "Settings":
        """Return the default values without reading the environment or a file, so that results can be reproduced."""
        return cls.model_construct()
