"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """The settings of `actum record --events`, beside those of every service."""

    history_file_mb: float = Field(
        16.0,
        gt=0,
        description=("history of events: at this size (MB) a file is finished and the next file is started"),
    )
    history_file_hours: float = Field(
        24.0,
        gt=0,
        description=(
            "history of events: maximum time that one file of the history covers (h); after this time "
            "the next file is started"
        ),
    )
    history_keep_files: int | None = Field(
        None,
        ge=1,
        description=(
            "history of events: maximum number of finished files with events; if there are more, "
            "the oldest are deleted. Default: all files are kept"
        ),
    )
    history_keep_mb: float | None = Field(
        None,
        gt=0,
        description=(
            "history of events: maximum total size of the finished files with events (MB); if the "
            "total is larger, the oldest are deleted. Default: all files are kept"
        ),
    )
