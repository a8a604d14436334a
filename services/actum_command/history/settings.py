"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """What `actum record --events` can be told beside what every service can."""

    history_file_mb: float = Field(16.0, gt=0, description="size at which a file is finished and the next one begun")
    history_file_hours: float = Field(24.0, gt=0, description="age at which a file is finished and the next one begun")
    history_keep_files: int | None = Field(None, ge=1, description="number of files beyond which the oldest is deleted")
    history_keep_mb: float | None = Field(
        None, gt=0, description="size of all finished files beyond which the oldest is deleted"
    )
