"""The hosts of a deployment: their names, addresses and sensors, and how `actum deploy init` is told of them."""

import re
from dataclasses import dataclass, replace
from ipaddress import ip_address

from pydantic import ConfigDict

from actum.keys import chunk
from actum.settings import HIGHEST_PORT, SettingsError
from actum_deployer.roles import (
    BODIES_BRIDGE,
    BRIDGE,
    CLASSIFIER,
    FUSION,
    GATEWAY,
    PAGE,
    PREPROCESSOR,
    TRACKER,
    TRAINER,
)

DEFAULT_PORT = 7447
"""Zenoh's usual port."""
HOST_NAME = re.compile(
    r"(?=.{1,253}$)(?!-)[A-Za-z0-9_-]{1,63}(?<!-)(\.(?!-)[A-Za-z0-9_-]{1,63}(?<!-))*(?<!\.)", re.ASCII
)
"""A host's name that a certificate may hold: labels of ASCII letters, digits, hyphens and underscores."""
NUMERIC = re.compile(r"(.*\.)?[0-9]+")
"""What is no name but an address of IPv4, or none that can be: its last label is a number."""
KINDS = {
    "camera": (GATEWAY, TRACKER),
    "compute": (PREPROCESSOR, CLASSIFIER, FUSION, TRAINER, PAGE, BRIDGE, BODIES_BRIDGE),
}
"""The roles of the services on each kind of host, by the beginning of the host's name."""
STRICT = ConfigDict(extra="forbid")
"""Of what is read from the file: a misspelt field would be taken for one that is not there."""


@dataclass(frozen=True)
class Host:
    """A machine.

    Attributes:
        name: its folder's name; begins with its kind.
        address: by which the others reach it.
        port: on which its router listens.
        sensors: the sensors that it has, or whose streams it computes with.
    """

    __pydantic_config__ = STRICT
    name: str
    address: str
    port: int
    sensors: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """`camera` or `compute`."""
        return next(kind for kind in KINDS if self.name.startswith(kind))

    @property
    def endpoint(self) -> str:
        """Where others reach its router, without the transport."""
        return f"[{self.address}]:{self.port}" if ":" in self.address else f"{self.address}:{self.port}"


def hosts_of(text: str, sensors: str | None = None) -> tuple[Host, ...]:
    """Parse `camera=ADDRESS,compute=ADDRESS:PORT`, and deal the sensors out.

    The first camera's sensor is `kinect0`, the second's `kinect1`, unless they are named. Hosts that compute take the
    sensors in turn.

    Raises:
        SettingsError: a name, an address or a port cannot be used, or these hosts and sensors do not go together.
    """
    hosts = [host_of(part.strip()) for part in text.split(",")]
    cameras = [host for host in hosts if host.kind == "camera"]
    computing = [host for host in hosts if host.kind == "compute"]
    named = sensors.split(",") if sensors is not None else [f"kinect{number}" for number in range(len(cameras))]
    if not cameras or not computing or len({host.name for host in hosts}) < len(hosts):
        raise SettingsError(
            f"hosts: {text!r} lacks a camera host or a compute host, or contains two hosts of one name: write for "
            "example camera=ADDRESS,camera2=ADDRESS,compute=ADDRESS"
        )
    if len(named) != len(cameras) or len(set(named)) < len(named):
        raise SettingsError(
            f"sensors: {sensors!r} does not consist of {len(cameras)} different names: name one sensor for each camera"
        )
    places = [_normal(host.endpoint) for host in hosts]
    if len({*places}) < len(places):
        raise SettingsError(
            f"hosts: in {text!r}, two hosts have the same address and port: give one of the two another address or port"
        )
    if len(computing) > len(named):
        raise SettingsError(
            f"hosts: {len(computing)} compute hosts are too many for {len(named)} cameras: give at most one compute "
            "host per camera"
        )
    its: dict[str, tuple[str, ...]] = {host.name: (chunk(sensor),) for host, sensor in zip(cameras, named, strict=True)}
    its |= {host.name: tuple(named[i :: len(computing)]) for i, host in enumerate(computing)}
    return tuple(replace(host, sensors=its[host.name]) for host in hosts)


def host_of(text: str) -> Host:
    """Parse `NAME=ADDRESS` or `NAME=ADDRESS:PORT`.

    Raises:
        SettingsError: the name, the address or the port cannot be used.
        InvalidKeyError: the name has characters that keys cannot have.
    """
    name, _, place = text.partition("=")
    address, colon, own_port = place.rpartition(":")
    if not colon or place.endswith("]") or (place.count(":") > 1 and "[" not in place):
        address, own_port = place, str(DEFAULT_PORT)
    chunk(name)
    if not any(name.startswith(kind) for kind in KINDS):
        raise SettingsError(
            f"hosts: {text!r} does not begin with {' or '.join(KINDS)}: begin the name before the '=' with one of the "
            "two words, such as camera2=192.168.1.5"
        )
    if not address or not own_port.isdecimal() or not 0 < int(own_port) <= HIGHEST_PORT:
        raise SettingsError(
            f"hosts: {text!r} does not have the form NAME=ADDRESS or NAME=ADDRESS:PORT: use this form, with a port "
            f"from 1 to {HIGHEST_PORT}"
        )
    address = address.removeprefix("[").removesuffix("]")
    if not _can_be_reached(address):
        raise SettingsError(
            f"hosts: {address!r} in {text!r} is not the address of a machine: use a host name or an IP address"
        )
    return Host(name, address, int(own_port))


def _can_be_reached(address: str) -> bool:
    """Tell whether an address is one of IPv4 or IPv6 that a machine can have, or a host's name in ASCII."""
    try:
        parsed = ip_address(address)
    except ValueError:
        return bool(HOST_NAME.fullmatch(address)) and not NUMERIC.fullmatch(address)
    if parsed.version == 6 and parsed.is_link_local:
        return False  # it holds on one interface alone, which endpoints and certificates cannot name
    return "%" not in address and not parsed.is_unspecified and not parsed.is_multicast


def _normal(endpoint: str) -> str:
    """Return what two endpoints have in common that lead to one place."""
    address, _, port = endpoint.rpartition(":")
    try:
        address = str(ip_address(address.strip("[]")))
    except ValueError:
        address = address.lower()
    return f"{address} {port}"
