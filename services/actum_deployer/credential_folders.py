"""Folders of credentials: for each role on each host, for people elsewhere, and the authority's own."""

import json
import os
import secrets
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from actum.atomic_file import PRIVATE_FOLDER, write_whole
from actum.runtime.credentials import AUTHORITY, CERTIFICATE, KEY, USER, USERS
from actum.settings import SettingsError
from actum_deployer.certificates import Signed, new_authority, new_certificate, now
from actum_deployer.deployment import Deployment, Host
from actum_deployer.roles import ROUTER, identity, router_identity

AUTHORITYS = "authority"
"""The folder of the authority: with its key anybody can make credentials, so it belongs on no host."""
PEOPLES_FOLDER = "people"
"""The folder of credentials for people's programs, on whichever machine."""
CREDENTIALS = "credentials"
"""The folder of credentials below that of a host."""
PASSWORD_BYTES = 24
"""Random bytes of a password: nobody has to type it."""
SERVICES_USER = 10001
"""The user as which containers run, who has to be able to read the private keys."""
PRIVATE = 0o600
"""The mode of files that nobody but their owner may read."""


@dataclass(frozen=True)
class Folder:
    """A folder of credentials: the common name of whose they are, and the addresses of a router; none for a client."""

    path: Path
    name: str
    addresses: Sequence[str] = ()


def folders(deployment: Deployment, root: Path) -> Iterator[Folder]:
    """Yield every folder of credentials."""
    for host in deployment.hosts:
        yield from _folders_of(deployment, host, root / host.name / CREDENTIALS)
    for role in deployment.peoples:
        yield Folder(root / PEOPLES_FOLDER / role.name, deployment.common_name(identity(role, "")))


def write_credentials(deployment: Deployment, root: Path, days: float) -> None:
    """Write all credentials anew, signed by the deployment's authority, which is made where there is none.

    Passwords stay as they are. Each file is replaced as a whole, so that a router or service may read it meanwhile.

    Raises:
        SettingsError: the authority's files cannot be used.
        OSError: a file cannot be written.
    """
    authority = _authority(root / AUTHORITYS)
    written = list(folders(deployment, root))
    passwords = _passwords(written) if deployment.passwords else {}
    for folder in written:
        make_private(folder.path.parent)
        make_private(folder.path)
        signed = new_certificate(authority, folder.name, now(), days, folder.addresses)
        write_whole(folder.path / KEY, signed.key_pem, PRIVATE)
        write_whole(folder.path / CERTIFICATE, signed.certificate_pem, PRIVATE)
        write_whole(folder.path / AUTHORITY, authority.certificate_pem, PRIVATE)
        if passwords:
            write_whole(folder.path / USER, _login(folder.name, passwords[folder.name]), PRIVATE)
        if passwords and folder.addresses:
            users = "".join(f"{user}:{password}\n" for user, password in sorted(passwords.items()))
            write_whole(folder.path / USERS, users.encode(), PRIVATE)
    _hand_over([folder.path for folder in written if folder.path.parent.name == CREDENTIALS])


def _folders_of(deployment: Deployment, host: Host, path: Path) -> Iterator[Folder]:
    if host in deployment.routers:
        addresses = [host.address, ROUTER, "localhost", "127.0.0.1", "::1"]
        name = deployment.common_name(router_identity(host.name))
        yield Folder(path / ROUTER, name, list(dict.fromkeys(addresses)))
    for role, sensor in deployment.roles_of(host):
        own = identity(role, sensor)
        yield Folder(path / own, deployment.common_name(own))


def _authority(folder: Path) -> Signed:
    make_private(folder)
    if (folder / KEY).exists():
        try:
            (folder / KEY).chmod(PRIVATE)
            return Signed.load((folder / AUTHORITY).read_bytes(), (folder / KEY).read_bytes())
        except (OSError, ValueError) as error:
            raise SettingsError(f"the authority in {folder} cannot be used: {error}") from None
    made = new_authority(f"actum {secrets.token_hex(4)}", now())
    write_whole(folder / KEY, made.key_pem, PRIVATE)
    write_whole(folder / AUTHORITY, made.certificate_pem, PRIVATE)
    return made


def _passwords(written: Sequence[Folder]) -> dict[str, str]:
    """Return a password for each name: the one that its folder holds already, or a new one."""
    passwords: dict[str, str] = {}
    for folder in written:
        file = folder.path / USER
        if file.exists():
            login = json.loads(file.read_text())["transport"]["auth"]["usrpwd"]
            passwords[login["user"]] = login["password"]
        passwords.setdefault(folder.name, secrets.token_urlsafe(PASSWORD_BYTES))
    return {folder.name: passwords[folder.name] for folder in written}


def _login(user: str, password: str) -> bytes:
    return json.dumps({"transport": {"auth": {"usrpwd": {"user": user, "password": password}}}}).encode() + b"\n"


def make_private(folder: Path) -> None:
    """Make a folder that nobody but its owner may enter, also where it was another one before."""
    folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
    folder.chmod(PRIVATE_FOLDER)


def _hand_over(written: Sequence[Path]) -> None:
    """Give folders to the user of containers, where this program may; else the README says how."""
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        return
    for folder in written:
        for each in (folder, *folder.iterdir()):
            os.chown(each, SERVICES_USER, SERVICES_USER)
