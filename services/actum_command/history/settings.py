"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """The settings of `actum record --events`, beside those of every service."""

    history_file_mb: float = Field(
        16.0,
        gt=0,
        description="size (MB) at which a file of the event history is closed; new messages then go to a new file",
    )
    history_file_hours: float = Field(
        24.0,
        gt=0,
        description="age (h) at which a file of the event history is closed; new messages then go to a new file",
    )
    history_keep_files: int | None = Field(
        None,
        ge=1,
        description=(
            "maximum number of closed files of the event history; when there are more, the oldest file is deleted. "
            "Default: all files are kept"
        ),
    )
    history_keep_mb: float | None = Field(
        None,
        gt=0,
        description=(
            "maximum total size of the closed files of the event history (MB); when they are larger, the oldest file "
            "is deleted. Default: all files are kept"
        ),
    )
