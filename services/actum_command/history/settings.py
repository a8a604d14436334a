"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """What `actum record --events` can be told beside what every service can."""

    history_file_mb: float = Field(
        16.0, gt=0, description="size at which a file is finished and the next one begun (MB)"
    )
    history_file_hours: float = Field(
        24.0, gt=0, description="age at which a file is finished and the next one begun (h)"
    )
    history_keep_files: int | None = Field(
        None, ge=1, description="number of finished files above which the oldest is deleted"
    )
    history_keep_mb: float | None = Field(
        None, gt=0, description="total size of the finished files above which the oldest is deleted (MB)"
    )
