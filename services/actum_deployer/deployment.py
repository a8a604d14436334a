"""A deployment: its hosts, what runs on each, and how strictly they are closed. Kept as a file without secrets."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from ipaddress import ip_address
from pathlib import Path
from typing import Self

from pydantic import ConfigDict, TypeAdapter, ValidationError

from actum.atomic_file import write_whole
from actum.keys import InvalidKeyError, chunk
from actum.settings import HIGHEST_PORT, SettingsError
from actum_deployer.roles import (
    BODIES_BRIDGE,
    BRIDGE,
    CLASSIFIER,
    DETECTOR,
    FUSION,
    GATEWAY,
    PAGE,
    PEOPLES,
    PREPROCESSOR,
    TRACKER,
    TRAINER,
    Role,
    common_name,
    identity,
)

ROUTERS_CANNOT = (
    "A router's credentials cannot be revoked, because clients would still trust them. To replace a router's "
    "credentials, delete authority/, run 'actum deploy init' and copy all folders to their machines again"
)
"""Why the credentials of a router cannot be revoked: clients know it by its address, not by its name."""
FILE = "deployment.json"
"""The name of the file in the deployment's folder."""
DEFAULT_PORT = 7447
"""Zenoh's usual port."""
KINDS = {
    "camera": (GATEWAY, TRACKER),
    "compute": (PREPROCESSOR, CLASSIFIER, FUSION, TRAINER, PAGE, BRIDGE, BODIES_BRIDGE),
}
"""The roles of the services on each kind of host, by the beginning of the host's name."""
HOST_NAME = re.compile(
    r"(?=.{1,253}$)(?!-)[A-Za-z0-9_-]{1,63}(?<!-)(\.(?!-)[A-Za-z0-9_-]{1,63}(?<!-))*(?<!\.)", re.ASCII
)
"""A host's name that a certificate may hold: labels of ASCII letters, digits, hyphens and underscores."""
FRAME = re.compile(r"[A-Za-z0-9_./-]{1,200}", re.ASCII)
"""A frame's name that systemd's units and compose files hold as it is."""
NUMERIC = re.compile(r"(.*\.)?[0-9]+")
"""What is no name but an address of IPv4, or none that can be: its last label is a number."""


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


@dataclass(frozen=True)
class Deployment:
    """All hosts, and what holds for all of them.

    Attributes:
        hosts: the machines.
        secured: whether routers ask for certificates; else whoever reaches one is trusted with everything.
        passwords: whether they ask for user names and passwords too.
        images_cross: whether images go from one host to another.
        one_router: whether the first host's router serves all, instead of one on each host.
        simulated: whether the simulated scene stands in the place of cameras.
        revoked: how often the credentials of an identity were revoked.
        ros_domain: the domain of the bridge to ROS 2; None where there is none.
        ros_bodies: the optical frame, in the robot's tree, of the camera whose bodies the bridge publishes as the
            skeletons of the only sensor, in place of a gateway; None where there is a gateway.
    """

    __pydantic_config__ = STRICT
    hosts: tuple[Host, ...]
    secured: bool = True
    passwords: bool = False
    images_cross: bool = False
    one_router: bool = False
    simulated: bool = False
    revoked: Mapping[str, int] = field(default_factory=dict)
    ros_domain: int | None = None
    ros_bodies: str | None = None

    @property
    def routers(self) -> tuple[Host, ...]:
        """The hosts with a router."""
        return self.hosts[:1] if self.one_router else self.hosts

    @property
    def sensors(self) -> tuple[str, ...]:
        """All sensors."""
        return tuple(sensor for host in self.hosts if host.kind == "camera" for sensor in host.sensors)

    @property
    def subjects(self) -> list[tuple[Role, str]]:
        """Every role with the sensors that it is for, all of people's included."""
        return [*(each for host in self.hosts for each in self.roles_of(host)), *((role, "") for role in self.peoples)]

    @property
    def peoples(self) -> tuple[Role, ...]:
        """The roles of people's programs."""
        return self._taking_part(PEOPLES)

    def roles_of(self, host: Host) -> list[tuple[Role, str]]:
        """Return the roles of a host's services, each with its sensor, or with all of the host's: `left,right`."""
        together = (",".join(host.sensors),)
        roles = self._taking_part(KINDS[host.kind])
        return [(role, its) for role in roles for its in (together if role.serves_several else host.sensors)]

    def _taking_part(self, roles: Iterable[Role]) -> tuple[Role, ...]:
        absent = (BODIES_BRIDGE, DETECTOR) if self.ros_bodies is None else (BRIDGE,)
        spoken = (role for role in roles if self.ros_domain is not None or not role.speaks_ros)
        return tuple(role for role in spoken if role not in absent)

    @property
    def transport(self) -> str:
        """The transport of every endpoint."""
        return "tls" if self.secured else "tcp"

    def common_name(self, identity: str) -> str:
        """Return the name by which routers know an identity now."""
        return common_name(identity, self.revoked.get(identity, 0))

    def revoking(self, identities: Sequence[str]) -> Self:
        """Return the same deployment with the credentials of some identities revoked.

        Raises:
            SettingsError: there is no such identity, or it is a router's.
        """
        known = {identity(role, sensor) for role, sensor in self.subjects}
        for each in identities:
            if each not in known:
                raise SettingsError(
                    f"revoke: {each!r} names no credentials that can be revoked: use one of "
                    f"{', '.join(sorted(known))}. {ROUTERS_CANNOT}"
                )
        again = {each: self.revoked.get(each, 0) + 1 for each in identities}
        return replace(self, revoked={**self.revoked, **again})

    def save(self, folder: Path) -> None:
        """Write the file."""
        write_whole(folder / FILE, (json.dumps(asdict(self), indent=2) + "\n").encode())

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read the file.

        Raises:
            SettingsError: it is not there, or is none.
        """
        try:
            read = TypeAdapter(cls).validate_json((folder / FILE).read_bytes())
            if not read.hosts:
                raise SettingsError("the list `hosts` is empty")
            for host in read.hosts:  # as if it had been said to `actum deploy init`
                _host(f"{host.name}={host.endpoint}")
                for sensor in host.sensors:
                    chunk(sensor)
        except FileNotFoundError:
            raise SettingsError(
                f"{folder} contains no {FILE}: create the deployment with 'actum deploy init'"
            ) from None
        except (OSError, ValidationError, SettingsError, InvalidKeyError) as error:
            problem = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error
            raise SettingsError(
                f"{folder / FILE} cannot be used ({problem}): correct this file. Do not delete it, because it lists "
                "the revoked credentials. If the file cannot be corrected, delete it and the folder authority/, run "
                "'actum deploy init' and copy all folders to their machines again"
            ) from None
        return read


def hosts_of(text: str, sensors: str | None = None) -> tuple[Host, ...]:
    """Parse `camera=ADDRESS,compute=ADDRESS:PORT`, and deal the sensors out.

    The first camera's sensor is `kinect0`, the second's `kinect1`, unless they are named. Hosts that compute take the
    sensors in turn.

    Raises:
        SettingsError: a name, an address or a port cannot be used, or these hosts and sensors do not go together.
    """
    hosts = [_host(part.strip()) for part in text.split(",")]
    cameras = [host for host in hosts if host.kind == "camera"]
    computing = [host for host in hosts if host.kind == "compute"]
    named = sensors.split(",") if sensors is not None else [f"kinect{number}" for number in range(len(cameras))]
    if not cameras or not computing or len({host.name for host in hosts}) < len(hosts):
        raise SettingsError(
            f"hosts: {text!r}: give camera=ADDRESS and compute=ADDRESS; "
            "further hosts need names of their own, such as camera2=ADDRESS"
        )
    if len(named) != len(cameras) or len(set(named)) < len(named):
        raise SettingsError(f"sensors: {sensors!r}: give {len(cameras)} different sensor names, one per camera")
    places = [_normal(host.endpoint) for host in hosts]
    if len({*places}) < len(places):
        raise SettingsError(
            f"hosts: {text!r}: two hosts have the same address and port: give one of them another address or port"
        )
    if len(computing) > len(named):
        raise SettingsError(
            f"hosts: {len(computing)} compute hosts are too many for {len(named)} cameras: give at most one compute "
            "host per camera"
        )
    its: dict[str, tuple[str, ...]] = {host.name: (chunk(sensor),) for host, sensor in zip(cameras, named, strict=True)}
    its |= {host.name: tuple(named[i :: len(computing)]) for i, host in enumerate(computing)}
    return tuple(replace(host, sensors=its[host.name]) for host in hosts)


def _host(text: str) -> Host:
    name, _, place = text.partition("=")
    address, colon, own_port = place.rpartition(":")
    if not colon or place.endswith("]") or (place.count(":") > 1 and "[" not in place):
        address, own_port = place, str(DEFAULT_PORT)
    chunk(name)
    if not any(name.startswith(kind) for kind in KINDS):
        raise SettingsError(
            f"hosts: {text!r}: the name before = has to begin with {' or '.join(KINDS)}, such as camera=192.168.1.5"
        )
    if not address or not own_port.isdecimal() or not 0 < int(own_port) <= HIGHEST_PORT:
        raise SettingsError(
            f"hosts: {text!r}: use NAME=ADDRESS or NAME=ADDRESS:PORT, with a port from 1 to {HIGHEST_PORT}"
        )
    address = address.removeprefix("[").removesuffix("]")
    if not _can_be_reached(address):
        raise SettingsError(
            f"hosts: {text!r}: {address!r} is not the address of a machine: use a host name or an IP address"
        )
    return Host(name, address, int(own_port))


def _can_be_reached(address: str) -> bool:
    """Tell whether an address is one of IPv4 or IPv6 that a machine can have, or a host's name in ASCII."""
    try:
        parsed = ip_address(address)
    except ValueError:
        return bool(HOST_NAME.fullmatch(address)) and not NUMERIC.fullmatch(address)
    return "%" not in address and not parsed.is_unspecified and not parsed.is_multicast


def _normal(endpoint: str) -> str:
    """Return what two endpoints have in common that lead to one place."""
    address, _, port = endpoint.rpartition(":")
    try:
        address = str(ip_address(address.strip("[]")))
    except ValueError:
        address = address.lower()
    return f"{address} {port}"
