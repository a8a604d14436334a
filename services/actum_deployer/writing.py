"""Writes a deployment: a folder for each host, one for people's programs, and the authority's own."""

from datetime import timedelta
from pathlib import Path

from actum_deployer.certificates import now
from actum_deployer.compose_file import compose_file
from actum_deployer.credential_folders import write_credentials
from actum_deployer.deployment import Deployment, Host
from actum_deployer.host_readme import UNITS, readme, settings_file
from actum_deployer.programs import FILES, SETTINGS
from actum_deployer.router_file import router_file
from actum_deployer.systemd_units import units


def write_deployment(deployment: Deployment, root: Path, days: float) -> None:
    """Write all files of a deployment; credentials are valid for `days`.

    The authority, passwords and the user's settings that are there already are kept.

    Raises:
        SettingsError: the authority that is there cannot be used.
        OSError: a file cannot be written.
    """
    for host in deployment.hosts:
        _write_host(deployment, host, root / host.name, days)
    if deployment.secured:
        write_credentials(deployment, root, days)
    deployment.save(root)


def _write_host(deployment: Deployment, host: Host, folder: Path, days: float) -> None:
    expiry = (now() + timedelta(days=days)).date()
    texts = {
        "compose.yml": compose_file(deployment, host),
        "README.md": readme(deployment, host, expiry),
        **{f"{UNITS}/{name}": text for name, text in units(deployment, host).items()},
    }
    if host in deployment.routers:
        texts["router.json5"] = router_file(deployment, host)
    if not (folder / SETTINGS).exists():
        texts[SETTINGS] = settings_file(deployment, host)
    for each in (UNITS, FILES):
        (folder / each).mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
