"""The configuration of a host's router, a JSON5 file that `actum router --config` and Eclipse's zenohd read."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from actum.runtime.credentials import router_values
from actum.runtime.session import TRANSPORT
from actum_deployer.access_control import access_control
from actum_deployer.credential_folders import CREDENTIALS
from actum_deployer.deployment import Deployment, Host
from actum_deployer.message_limits import message_limits
from actum_deployer.programs import INSTALLED
from actum_deployer.roles import ROUTER, router_identity

MOST_SESSIONS = 128
"""Most clients and routers at a time: some tens are in use, and each takes memory."""
RETRY = {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2}
"""How often a router tries to reach another (ms): a link that is back is used within a second."""


def router_file(deployment: Deployment, host: Host) -> str:
    """Return the text of the file."""
    values = router_configuration(deployment, host)
    about = (
        f"// The router of {host.name}, written by 'actum deploy init': change the arguments of that command, not "
        "this file.\n"
    )
    return about + json.dumps(_nested(values), indent=1) + "\n"


def router_configuration(deployment: Deployment, host: Host) -> dict[str, Any]:
    """Return the values of Zenoh's configuration by their paths."""
    earlier = deployment.routers[: deployment.routers.index(host)]
    routers = [deployment.common_name(router_identity(each.name)) for each in deployment.routers]
    transport = deployment.transport
    values = {
        "mode": "router",
        "listen/endpoints": [f"{transport}/0.0.0.0:{host.port}"],
        "connect/endpoints": [f"{transport}/{each.endpoint}" for each in earlier],
        "connect/retry": RETRY,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "adminspace": {"enabled": True, "permissions": {"read": True, "write": False}},
        **TRANSPORT,
        "transport/link/protocols": [transport],
        "transport/unicast/max_sessions": MOST_SESSIONS,
        **message_limits(deployment.sensors, deployment.ros_domain),
    }
    if not deployment.secured:
        return values
    rules = access_control(
        deployment.subjects,
        routers,
        deployment.images_cross,
        deployment.passwords,
        deployment.common_name,
        deployment.ros_domain,
    )
    files = router_values(Path(INSTALLED) / CREDENTIALS / ROUTER, deployment.passwords)
    return {**values, **files, "access_control": rules}


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by paths as sections within sections."""
    nested: dict[str, Any] = {}
    for path, value in values.items():
        section = nested
        *sections, name = path.split("/")
        for each in sections:
            section = section.setdefault(each, {})
        section[name] = value
    return nested
