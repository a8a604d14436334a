"""Settings of the service that keeps events."""

from pydantic import Field

from actum.settings import ServiceSettings


class Settings(ServiceSettings):
    """What `actum record --events` can be told beside what every service can."""

    history_file_mb: float = Field(16.0, gt=0, description="maximum size of a file; then the next file is started (MB)")
    history_file_hours: float = Field(
        24.0, gt=0, description="maximum time that a file covers; then the next file is started (h)"
    )
    history_keep_files: int | None = Field(
        None, ge=1, description="maximum number of finished files; the oldest are deleted. Default: all are kept"
    )
    history_keep_mb: float | None = Field(
        None,
        gt=0,
        description="maximum total size of the finished files; the oldest are deleted. Default: all are kept (MB)",
    )
