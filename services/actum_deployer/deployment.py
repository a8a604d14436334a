"""A deployment: its hosts, what runs on each, and how strictly they are closed. Kept as a file without secrets."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Self

from pydantic import TypeAdapter, ValidationError

from actum.atomic_file import write_whole
from actum.keys import InvalidKeyError, chunk
from actum.settings import SettingsError
from actum_deployer.hosts import KINDS, STRICT, Host, host_of
from actum_deployer.roles import BODIES_BRIDGE, BRIDGE, DETECTOR, PEOPLES, Role, common_name, identity

ROUTERS_CANNOT = (
    "A router's credentials cannot be revoked, because clients would still trust them. To replace a router's "
    "credentials, delete the folder authority/, run 'actum deploy init' and copy all folders to their machines again"
)
"""Why the credentials of a router cannot be revoked: clients know it by its address, not by its name."""
FILE = "deployment.json"
"""The name of the file in the deployment's folder."""
FRAME = re.compile(r"[A-Za-z0-9_./-]{1,200}", re.ASCII)
"""A frame's name that systemd's units and compose files hold as it is."""


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
                    f"revoke: {each!r} is not the name of credentials that can be revoked: use one of "
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
                raise SettingsError("the list `hosts` is empty; list at least one host")
            for host in read.hosts:  # as if it had been said to `actum deploy init`
                host_of(f"{host.name}={host.endpoint}")
                for sensor in host.sensors:
                    chunk(sensor)
        except FileNotFoundError:
            raise SettingsError(
                f"{folder} contains no file {FILE}: create the deployment with 'actum deploy init'"
            ) from None
        except (OSError, ValidationError, SettingsError, InvalidKeyError) as error:
            problem = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error
            raise SettingsError(
                f"{folder / FILE} cannot be used ({problem}): correct this file, which lists the revoked credentials. "
                "If you cannot correct the file, delete it together with the folder authority/, run 'actum deploy "
                "init' to make all credentials again, and copy each host's folder to its machine"
            ) from None
        return read
