"""Writes a deployment: a folder for each host, one for people's programs, and the authority's own."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path

from actum.atomic_file import PRIVATE_FOLDER, claim, write_whole
from actum.settings import SettingsError
from actum_deployer.certificates import now
from actum_deployer.compose_file import compose_file
from actum_deployer.credential_folders import (
    AUTHORITYS,
    PRIVATE,
    authority_of,
    lasting,
    passwords_of,
    write_credentials,
)
from actum_deployer.deployment import FILE, Deployment
from actum_deployer.host_readme import OWNERS, UNITS, USERS, readme, settings_file
from actum_deployer.hosts import Host
from actum_deployer.programs import FILES, ROUTER_FILE, SETTINGS
from actum_deployer.router_file import router_file
from actum_deployer.systemd_units import owners, units, users

PUBLIC, PUBLIC_FOLDER = 0o644, 0o755
"""The modes of what the users of containers and units have to read, whatever the umask: it holds no secret."""


LOCK = ".lock"
"""The file, in the deployment's folder, that who writes it has claimed."""


@contextmanager
def alone(root: Path) -> Iterator[None]:
    """Return a context in which no other process writes the deployment of a folder.

    Raises:
        SettingsError: another one does.
        OSError: the folder cannot be written.
    """
    with (root / LOCK).open("ab") as file:
        if not claim(file):
            raise SettingsError(f"another 'actum deploy' is writing {root}: wait until that command has ended")
        yield


def write_deployment(deployment: Deployment, root: Path, days: float, may_be_new: bool = True) -> None:
    """Write all files of a deployment; credentials are valid for `days`, but no longer than the authority.

    The authority, passwords and the user's settings that are there already are kept. Without `may_be_new` there has to
    be an authority. Nothing is written where one of these cannot be used.

    Raises:
        SettingsError: the authority or a password that is there cannot be used.
        OSError: a file cannot be written.
    """
    root.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
    passwords = passwords_of(deployment, root)
    authority = authority_of(root, may_be_new) if deployment.secured else None
    deployment.save(root)
    for host in deployment.hosts:
        _write_host(deployment, host, root / host.name, lasting(authority, days) if authority else days)
    if authority is not None:
        write_credentials(deployment, root, lasting(authority, days), authority, passwords)


def revoked_before(root: Path) -> Mapping[str, int]:
    """Return how often credentials were revoked in the deployment that a folder holds already, if it holds one.

    Raises:
        SettingsError: its authority is there, but not the file that says so.
    """
    if (root / FILE).exists() or not (root / AUTHORITYS).exists():
        return Deployment.load(root).revoked if (root / FILE).exists() else {}
    raise SettingsError(
        f"{root} contains the folder {AUTHORITYS}/ but not the file {FILE}, which lists the revoked credentials: "
        f"restore {FILE}. Or delete the folder {AUTHORITYS}/, run 'actum deploy init' again and copy all folders to "
        "their machines again"
    )


def _write_host(deployment: Deployment, host: Host, folder: Path, days: float) -> None:
    expiry = (now() + timedelta(days=days)).date()
    texts = {
        "compose.yml": compose_file(deployment, host),
        "README.md": readme(deployment, host, expiry),
        **{f"{UNITS}/{name}": text for name, text in units(deployment, host).items()},
        f"{UNITS}/{USERS}": users(deployment, host),
        f"{UNITS}/{OWNERS}": owners(deployment, host),
    }
    if host in deployment.routers:
        texts[ROUTER_FILE] = router_file(deployment, host)
    for each in (folder, folder / UNITS, folder / FILES):
        if not each.exists():
            each.mkdir()
            each.chmod(PUBLIC_FOLDER)  # the umask may have taken away what has to be read
    for name, text in texts.items():
        write_whole(folder / name, text.encode(), PUBLIC)
    if (folder / SETTINGS).exists():
        (folder / SETTINGS).chmod(PRIVATE)
    else:
        write_whole(folder / SETTINGS, settings_file(deployment, host).encode(), PRIVATE)
