"""Settings of a service: flags, `ACTUM_…` environment variables, or a TOML file named by `ACTUM_CONFIG`."""

import os
import re
import secrets
import socket
import sys
import tomllib
from pathlib import Path
from typing import Annotated, Self

from pydantic import AfterValidator, Field, ValidationError
from pydantic_core import ErrorDetails
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict, TomlConfigSettingsSource

from actum.keys import CHUNK

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
"""The router's endpoint where none is set: this machine, Zenoh's usual port."""
WITH_PORT = ("tcp", "udp", "tls", "quic", "ws")
"""Zenoh's transports whose addresses are host:port."""
OTHER_TRANSPORTS = ("unixsock-stream", "unixpipe", "serial", "vsock")
"""Zenoh's transports with other addresses."""
PROCESS_ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""The environment of every process of a system. One BLAS thread, as the processes share the cores and their matrix
products are too small to gain from more. One malloc arena (glibc): a dozen threads with arenas of their own fragment
the heap, and resident memory creeps up for tens of minutes."""
HIGHEST_PORT = 65535
"""Ports have 16 bits."""
LONGEST_HOST = 48
"""Characters of the host's name in an instance's, so that the rest fits behind it."""
NAME = f"^{CHUNK.pattern}$"
"""A sensor's or a process's name, which is one chunk of its keys."""
NAMES = f"^{CHUNK.pattern}(,{CHUNK.pattern})*$"
"""One such name, or several with commas between them."""
START = secrets.token_hex(2)
"""Tells this process from others of one host name and process id: hosts are copied, and a container's process is 1."""


class SettingsError(ValueError):
    """Settings that cannot be used; the text names the setting, the problem and what to do."""


def host_and_port(endpoint: str) -> tuple[str, int] | None:
    """Parse an endpoint into host and port; None where its transport has no ports.

    Raises:
        SettingsError: it is no endpoint of Zenoh's.
    """
    transport, _, address = re.split("[?#]", endpoint, maxsplit=1)[0].partition("/")
    if transport in OTHER_TRANSPORTS and address:
        return None
    host, colon, port = address.rpartition(":")
    if transport not in WITH_PORT or not colon or not port.isdecimal() or int(port) > HIGHEST_PORT:
        raise SettingsError(f"{endpoint!r} is not an endpoint: use tcp/host:port, such as {DEFAULT_ENDPOINT}")
    return host.strip("[]"), int(port)


def complaint(error: ValueError) -> str:
    """Return one line that describes an error in settings, whether pydantic or our own code raised it."""
    if not isinstance(error, ValidationError):
        return str(error)
    problems = [
        # no setting is named where several do not go together
        ": ".join(filter(None, [".".join(map(str, e["loc"])), _in_words(e)]))
        for e in error.errors(include_url=False)
    ]
    return f"settings: {'; '.join(problems)}"


def _in_words(error: ErrorDetails) -> str:
    pattern = error.get("ctx", {}).get("pattern")
    if pattern not in (NAME, NAMES):
        return error["msg"].removeprefix("Value error, ")
    if pattern == NAME and "," in error["input"]:
        return f"{error['input']!r} is more than one name: name one"
    return f"{error['input']!r} is not a name: use 1 to 64 of the characters a-z, 0-9, - and _"


def _endpoint(text: str) -> str:
    host_and_port(text)
    return text


def default_instance() -> str:
    """Return an instance name for this process: host, process id and its start, as a valid chunk of a key."""
    host = "".join(c if CHUNK.fullmatch(c) else "-" for c in socket.gethostname().lower())
    return f"{host[:LONGEST_HOST]}-{os.getpid()}-{START}"


def data_folder() -> Path:
    """Return the folder in which programs of this user keep their files, by the system's custom."""
    home = Path.home()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = home / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_DATA_HOME") or home / ".local" / "share")
    return base / "actum"


class ServiceSettings(BaseSettings):
    """The settings of every service."""

    model_config = SettingsConfigDict(
        env_prefix="ACTUM_",
        cli_kebab_case=True,
        cli_hide_none_type=True,
        cli_avoid_json=True,
        cli_implicit_flags=True,
        extra="ignore",
        allow_inf_nan=False,
    )

    connect: Annotated[str, AfterValidator(_endpoint)] = Field(
        DEFAULT_ENDPOINT, description="address of the Zenoh router, such as tcp/192.168.1.5:7447"
    )
    sensor: str = Field(
        "kinect0",
        pattern=NAME,
        description=(
            "name of the sensor, such as kinect0; programs exchange messages only if they have the same sensor name"
        ),
    )
    instance: str = Field(
        default_factory=default_instance,
        pattern=NAME,
        description=(
            "name of this process. Processes of the same service need different names; the generated default contains "
            "the host name and the process id"
        ),
    )
    take_over: bool = Field(
        False,
        description=(
            "if another process of this service already serves this sensor, stop that process and take its place"
        ),
    )
    zenoh_config: Path | None = Field(
        None,
        description=(
            "a Zenoh configuration file (JSON5), for example with settings for TLS and user names. Settings of actum, "
            "such as --connect, take precedence over this file"
        ),
    )
    credentials: Path | None = Field(
        None,
        description=(
            "the folder with this program's certificate and key, as written by `actum deploy`. Requires --connect "
            "tls/HOST:PORT. Default: no certificate"
        ),
    )
    health_file: Path | None = Field(
        None,
        description=(
            "a file for the health check of a container. While the service works, it sets the file's modification time "
            "to the current time every second. Default: no file"
        ),
    )

    @property
    def of_each_sensor(self) -> list[Self]:
        """The settings for each of the sensors: one, except for `NodeSettings`."""
        return [self.model_copy(update={"sensor": sensor}) for sensor in dict.fromkeys(self.sensor.split(","))]

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Return the sources of settings: flags first, then the environment, then the file that `ACTUM_CONFIG` names.

        Raises:
            SettingsError: that file does not exist, or is no TOML.
        """
        name = os.environ.get("ACTUM_CONFIG")
        if name and not Path(name).is_file():
            raise SettingsError(
                f"ACTUM_CONFIG names {name}, which does not exist or is not a file: correct or unset ACTUM_CONFIG"
            )
        try:
            return init_settings, env_settings, TomlConfigSettingsSource(settings_cls, toml_file=name or None)
        except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise SettingsError(
                f"ACTUM_CONFIG names {name}, which is not readable TOML ({error}): correct that file"
            ) from None


class NodeSettings(ServiceSettings):
    """The settings of a service, or of a whole system, that may serve several sensors."""

    sensor: str = Field(
        "kinect0",
        pattern=NAMES,
        description=(
            "name of the sensor, such as kinect0; programs exchange messages only if they have the same sensor name. "
            "For several sensors, list their names, such as left,right"
        ),
    )


class SharedSettings(NodeSettings):
    """The settings of a service whose sensors several processes may share."""

    share: bool = Field(
        False,
        description=(
            "divide the sensors among several processes of this service. Start each of these processes with --share. "
            "Each sensor is served by one process; if this process ends, another one takes over the sensor within 2 s"
        ),
    )


class RememberingSettings(SharedSettings):
    """The settings of a service whose answers a restart must not change."""

    state: Path | None = Field(
        None,
        description=(
            "a folder in which the service stores the results that it has published. After a restart, the service "
            "publishes no second, different result for the same segment. Ignored with --share, because processes that "
            "share sensors receive each other's results. Default: nothing is stored; 'actum up' uses a temporary folder"
        ),
    )
