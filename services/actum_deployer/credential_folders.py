"""Folders of credentials: for each role on each host, for people elsewhere, and the authority's own."""

import json
import os
import secrets
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path

from actum.atomic_file import PRIVATE_FOLDER, write_whole
from actum.runtime.credentials import AUTHORITY, CERTIFICATE, KEY, LOGIN, USER, USERS, login_values
from actum.settings import SettingsError
from actum_deployer.certificates import Signed, new_authority, new_certificate, now
from actum_deployer.deployment import Deployment
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
NEW_AUTHORITY = (
    "delete this folder, run 'actum deploy init', and copy the new credentials to all machines. The earlier "
    "credentials then become invalid"
)
"""What to do where the authority cannot be used."""


@dataclass(frozen=True)
class Folder:
    """A folder of credentials: the common name of whose they are, and the addresses of a router; none for a client."""

    path: Path
    name: str
    addresses: Sequence[str] = ()


def folders(deployment: Deployment, root: Path) -> Iterator[Folder]:
    """Yield every folder of credentials."""
    for host in deployment.hosts:
        path = root / host.name / CREDENTIALS
        if host in deployment.routers:
            addresses = [host.address, ROUTER, "localhost", "127.0.0.1", "::1"]
            name = deployment.common_name(router_identity(host.name))
            yield Folder(path / ROUTER, name, list(dict.fromkeys(addresses)))
        for role, sensor in deployment.roles_of(host):
            own = identity(role, sensor)
            yield Folder(path / own, deployment.common_name(own))
    for role in deployment.peoples:
        yield Folder(root / PEOPLES_FOLDER / role.name, deployment.common_name(identity(role, "")))


def passwords_of(deployment: Deployment, root: Path) -> dict[str, str]:
    """Return a password for each name, the one that its folder holds already or a new one; none where none are asked.

    Raises:
        SettingsError: a file that is there holds none.
    """
    written = list(folders(deployment, root)) if deployment.passwords else []
    passwords: dict[str, str] = {}
    for folder in written:
        try:
            login = login_values(folder.path)
        except SettingsError as error:
            raise SettingsError(
                f"{error}. You can also delete {folder.path / USER}: 'actum deploy' then makes a new password"
            ) from None
        if login:
            passwords[login[f"{LOGIN}/user"]] = login[f"{LOGIN}/password"]
        passwords.setdefault(folder.name, secrets.token_urlsafe(PASSWORD_BYTES))
    return {folder.name: passwords[folder.name] for folder in written}


def write_credentials(
    deployment: Deployment, root: Path, days: float, authority: Signed, passwords: Mapping[str, str]
) -> None:
    """Write all credentials anew, signed by the deployment's authority.

    Each file is replaced as a whole, so that a router or service may read it meanwhile.

    Raises:
        OSError: a file cannot be written.
    """
    written = list(folders(deployment, root))
    for folder in written:
        make_private(folder.path.parent)
        make_private(folder.path)
        signed = new_certificate(authority, folder.name, now(), days, folder.addresses)
        write_whole(folder.path / KEY, signed.key_pem, PRIVATE)
        write_whole(folder.path / CERTIFICATE, signed.certificate_pem, PRIVATE)
        write_whole(folder.path / AUTHORITY, authority.certificate_pem, PRIVATE)
        if passwords:
            login = {"user": folder.name, "password": passwords[folder.name]}
            document = json.dumps({"transport": {"auth": {"usrpwd": login}}}) + "\n"
            write_whole(folder.path / USER, document.encode(), PRIVATE)
        else:  # a router that finds earlier ones asks for them
            (folder.path / USER).unlink(missing_ok=True)
            (folder.path / USERS).unlink(missing_ok=True)
        if passwords and folder.addresses:
            users = "".join(f"{user}:{password}\n" for user, password in sorted(passwords.items()))
            write_whole(folder.path / USERS, users.encode(), PRIVATE)
    _hand_over([folder.path for folder in written if folder.path.parent.name == CREDENTIALS])


def authority_of(root: Path, may_be_made: bool) -> Signed:
    """Return the deployment's authority; make it where nothing of one is left and a new one may take its place.

    Raises:
        SettingsError: its files cannot be used, or it has ended.
        OSError: they cannot be written.
    """
    folder = root / AUTHORITYS
    if may_be_made and not ((folder / KEY).exists() or (folder / AUTHORITY).exists()):
        made = new_authority(f"actum {secrets.token_hex(4)}", now())
        make_private(folder)
        write_whole(folder / KEY, made.key_pem, PRIVATE)
        write_whole(folder / AUTHORITY, made.certificate_pem, PRIVATE)
        return made
    try:
        make_private(folder)
        (folder / KEY).chmod(PRIVATE)
        found = Signed.load((folder / AUTHORITY).read_bytes(), (folder / KEY).read_bytes())
    except (OSError, ValueError) as error:
        raise SettingsError(
            f"the certificate authority in {folder} cannot be used ({error}): restore {AUTHORITY} and {KEY} in this "
            f"folder. If you cannot, {NEW_AUTHORITY}"
        ) from None
    if lasting(found, 1) <= 0:
        expired = found.certificate.not_valid_after_utc
        raise SettingsError(
            f"the certificate authority in {folder} expired at {expired:%Y-%m-%d %H:%M} UTC: {NEW_AUTHORITY}"
        )
    return found


def lasting(authority: Signed, days: float) -> float:
    """Return for how many days from now certificates can last: no longer than their authority."""
    return min(days, (authority.certificate.not_valid_after_utc - now()) / timedelta(days=1))


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
