"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """The settings of `actum record --events`, beside those of every service."""

    history_file_mb: float = Field(
        16.0,
        gt=0,
        description="history of events: size of the current file (MB) at which the service starts the next file",
    )
    history_file_hours: float = Field(
        24.0,
        gt=0,
        description="history of events: time (h) after which the service starts the next file",
    )
    history_keep_files: int | None = Field(
        None,
        ge=1,
        description=(
            "history of events: maximum number of finished files. If there are more, the service deletes the oldest "
            "files. Default: all files are kept"
        ),
    )
    history_keep_mb: float | None = Field(
        None,
        gt=0,
        description=(
            "history of events: maximum total size of the finished files (MB). If the total is larger, the service "
            "deletes the oldest files. Default: all files are kept"
        ),
    )
