"""Settings of a service: flags, `ACTUM_…` environment variables, or a TOML file named by `ACTUM_CONFIG`."""

import os
import socket
from pathlib import Path

from pydantic import Field
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict, TomlConfigSettingsSource

from actum.keys import CHUNK

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"


def default_instance() -> str:
    """Name this process among others of its service: host and process id, fit for a key chunk."""
    host = "".join(c if CHUNK.fullmatch(c) else "-" for c in socket.gethostname().lower())
    return f"{host}-{os.getpid()}"


class ServiceSettings(BaseSettings):
    """What every service can be told."""

    model_config = SettingsConfigDict(
        env_prefix="ACTUM_",
        cli_parse_args=False,
        cli_kebab_case=True,
        cli_hide_none_type=True,
        cli_avoid_json=True,
        cli_implicit_flags=True,
        extra="ignore",
    )

    connect: str = Field(DEFAULT_ENDPOINT, description="the router's endpoint")
    sensor: str = Field(
        "kinect0", pattern=f"^{CHUNK.pattern}$", description="the viewpoint: the chunk after actum/ in every key"
    )
    instance: str = Field(
        default_factory=default_instance, pattern=f"^{CHUNK.pattern}$", description="this process's name among its like"
    )
    zenoh_config: Path | None = Field(
        None, description="a JSON5 file laid under the session's configuration (TLS, users)"
    )
    health_file: Path | None = Field(None, description="a file touched every second while connected and working")

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Flags first, then the environment, then the file that `ACTUM_CONFIG` names."""
        file = TomlConfigSettingsSource(settings_cls, toml_file=os.environ.get("ACTUM_CONFIG"))
        return init_settings, env_settings, file
