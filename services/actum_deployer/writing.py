"""Writes a deployment: a folder for each host, one for people's programs, and the authority's own."""

from pathlib import Path

from actum_deployer.credential_folders import write_credentials
from actum_deployer.deployment import Deployment
from actum_deployer.router_file import router_file


def write_deployment(deployment: Deployment, root: Path, days: float) -> None:
    """Write all files of a deployment; credentials are valid for `days`.

    Raises:
        SettingsError: the authority that is there cannot be used.
        OSError: a file cannot be written.
    """
    for host in deployment.hosts:
        (root / host.name).mkdir(parents=True, exist_ok=True)
    deployment.save(root)
    if deployment.secured:
        write_credentials(deployment, root, days)
    for host in deployment.routers:
        (root / host.name / "router.json5").write_text(router_file(deployment, host), encoding="utf-8")
