"""The compose file of a host: what runs there, as closed as containers can be."""

from pathlib import PurePosixPath
from typing import Any

import yaml

from actum_deployer.credential_folders import SERVICES_USER
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import Host
from actum_deployer.programs import (
    FILES,
    INSTALLED,
    MOST_TASKS,
    ROUTER_FILE,
    SETTINGS,
    STATEFUL,
    Data,
    Program,
    environment,
    own_settings,
    programs,
)
from actum_deployer.roles import BRIDGE, CLASSIFIER, GATEWAY, ROUTER, TRACKER, TRAINER

TEMPORARY = "/tmp:size=64m"
"""The only place where a container may write besides its volumes: health file, caches of libraries."""
DATA = Data(models="/models", state="/state")
"""Where volumes are mounted: folders that the images make their users'."""
PAGE_IN_CONTAINER = {"ACTUM_PAGE_HOST": "0.0.0.0", "ACTUM_PAGE_GUARDED": "1"}
"""All interfaces are the container's own, and the host publishes the port to itself alone."""


def compose_file(deployment: Deployment, host: Host) -> str:
    """Return the text of the file."""
    running = [program for program in programs(deployment, host) if program.role is not BRIDGE]  # no image has it
    services = {program.name: _service(deployment, host, program) for program in running}
    mounts = [mount for service in services.values() for mount in service["volumes"]]
    volumes: dict[str, Any] = {mount.partition(":")[0]: {} for mount in mounts if not mount.startswith(".")}
    content = {"name": f"actum-{host.name}", "services": services, **({"volumes": volumes} if volumes else {})}
    about = f"# Services of {host.name}, written by 'actum deploy init'. Put your own settings into {SETTINGS}.\n"
    return about + yaml.safe_dump(content, sort_keys=False, width=120)


def _service(deployment: Deployment, host: Host, program: Program) -> dict[str, Any]:
    service = {
        "image": program.image,
        "pull_policy": "never",
        **_closed(program),
        "environment": environment(deployment, host, program, ROUTER, DATA),
        "volumes": _mounts(program),
    }
    if program.role is None:
        command = ["router", "--config", f"{INSTALLED}/{ROUTER_FILE}"]
        return {**service, "command": command, "ports": [f"{host.port}:{host.port}"]}
    service["env_file"] = [{"path": path, "required": False} for path in (SETTINGS, own_settings(program))]
    if program.role is TRAINER:
        service["entrypoint"] = ["python", "-m", program.module]
    if program.role is GATEWAY and not deployment.simulated:
        service["devices"] = ["${ACTUM_CAMERA_DEVICE:-/dev/video0}:/dev/video0"]
        service["group_add"] = ["video"]
    if program.page_port:
        service["environment"] |= PAGE_IN_CONTAINER
        service["ports"] = [f"127.0.0.1:{program.page_port}:{program.page_port}"]
    return service


def _closed(program: Program) -> dict[str, Any]:
    """Return what every container lacks: root, a disk to write on, capabilities, and more memory than it needs."""
    return {
        "init": True,
        "restart": "unless-stopped",
        "user": f"{SERVICES_USER}:{SERVICES_USER}",
        "read_only": True,
        "tmpfs": [TEMPORARY],
        "cap_drop": ["ALL"],
        "security_opt": ["no-new-privileges:true"],
        "mem_limit": f"{program.memory_mb}m",
        "pids_limit": MOST_TASKS,
        "stop_grace_period": "10s",
    }


def _mounts(program: Program) -> list[str]:
    """Return the mounts of a program: its credentials as a folder, so that renewed files are seen, and models."""
    mounts = []
    if program.credentials:
        mounts.append(f"./{PurePosixPath(program.credentials).relative_to(INSTALLED)}:{program.credentials}:ro")
    if program.role in (GATEWAY, TRACKER):
        mounts.append(f"./{FILES}:{INSTALLED}/{FILES}:ro")
    if program.role is None:
        mounts.append(f"./{ROUTER_FILE}:{INSTALLED}/{ROUTER_FILE}:ro")
    if program.role in (CLASSIFIER, TRAINER):
        mounts.append(f"models:{DATA.models}{':ro' if program.role is CLASSIFIER else ''}")
    if program.role in STATEFUL:
        mounts.append(f"state_{program.name}:{DATA.state}")
    return mounts
