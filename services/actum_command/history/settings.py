"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """The settings of `actum record --events`, beside those of every service."""

    history_file_mb: float = Field(
        16.0,
        gt=0,
        description=("history of events: size of a file (MB) at which recording continues in a new file"),
    )
    history_file_hours: float = Field(
        24.0,
        gt=0,
        description=("history of events: age of a file (h) at which recording continues in a new file"),
    )
    history_keep_files: int | None = Field(
        None,
        ge=1,
        description=(
            "history of events: maximum number of files to keep, not counting the file that is being written. The "
            "oldest files are deleted first. Default: all files are kept"
        ),
    )
    history_keep_mb: float | None = Field(
        None,
        gt=0,
        description=(
            "history of events: maximum total size of the files to keep (MB), not counting the file that is being "
            "written. The oldest files are deleted first. Default: all files are kept"
        ),
    )
