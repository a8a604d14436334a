"""Units of systemd, for hosts without containers: what runs there, as closed as services can be.

Each program has a user of its own, and only that user's group may read its credentials: with one user for all, whoever
takes one service over would have every role of the host. The users are declared as systemd-sysusers reads them, owners
and modes as systemd-tmpfiles does. Credentials stay in files, not in `LoadCredential=`, which a service would see
renewed only once it is started anew.
"""

from actum_deployer.credential_folders import CREDENTIALS
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
from actum_deployer.roles import CLASSIFIER, GATEWAY, TRAINER, shortened

VENV = "/opt/actum"
"""Where actum is installed: a virtual environment of its own."""
STATE = "/var/lib/actum"
"""Where each service that keeps anything has a folder of its own, which systemd makes its user's."""
STATE_FOLDER = """\
StateDirectory=actum/{name}
StateDirectoryMode=0750
"""
"""What is said of that folder: of the trainer's, whose group the classifier is in, it reads the model."""
LONGEST_USER = 31
"""Characters of a user's name, by Linux's tools."""
MADE = "# Made by 'actum deploy init'."
"""What stands first in each file of systemd's."""
UNIT = """\
# Made by 'actum deploy init'. Settings of yours belong into {installed}/{settings}.
[Unit]
Description=actum: {about}
Wants=network-online.target
After=network-online.target
StartLimitIntervalSec=0

[Service]
User={user}
Group={user}
{supplementary}{environment}
EnvironmentFile=-{installed}/{settings}
EnvironmentFile=-{installed}/{own_settings}
ExecStart={command}
Restart=always
RestartSec=1
TimeoutStopSec=10
UMask=0027
{state}NoNewPrivileges=yes
CapabilityBoundingSet=
ProtectSystem=strict
ProtectHome=yes
ProtectKernelTunables=yes
ProtectKernelModules=yes
ProtectControlGroups=yes
ProtectKernelLogs=yes
ProtectHostname=yes
ProtectProc=invisible
RestrictNamespaces=yes
RestrictSUIDSGID=yes
LockPersonality=yes
PrivateTmp=yes
{devices}RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6 AF_NETLINK
MemoryMax={memory_mb}M
TasksMax={tasks}

[Install]
WantedBy=multi-user.target
"""


def units(deployment: Deployment, host: Host) -> dict[str, str]:
    """Return the texts of a host's units by their files' names."""
    running = programs(deployment, host)
    return {f"actum-{program.name}.service": _unit(deployment, host, program) for program in running}


def users(deployment: Deployment, host: Host) -> str:
    """Return the declaration of the programs' users, as systemd-sysusers reads it."""
    lines = [f'u {user_of(each.name)} - "actum {each.name}"' for each in programs(deployment, host)]
    return "\n".join([MADE, *lines, ""])


def owners(deployment: Deployment, host: Host) -> str:
    """Return who may read which of the installed files, as systemd-tmpfiles reads it."""
    lines = [
        MADE,
        f"d {INSTALLED} 0755 root root",
        f"z {INSTALLED}/*.env 0600 root root",
        f"d {INSTALLED}/{FILES} 0755 root root",
        f"Z {INSTALLED}/{FILES}/* ~0755 root root",
    ]
    if host in deployment.routers:
        lines.append(f"z {INSTALLED}/{ROUTER_FILE} 0644 root root")
    if deployment.secured:
        lines.append(f"d {INSTALLED}/{CREDENTIALS} 0711 root root")
    for program in programs(deployment, host):
        if program.credentials:
            lines.append(f"z {program.credentials} 0750 root {user_of(program.name)}")
            lines.append(f"z {program.credentials}/* 0640 root {user_of(program.name)}")
    return "\n".join([*lines, ""])


def user_of(name: str) -> str:
    """Return the name of a program's user, and of that user's group."""
    return shortened(f"actum-{name}", LONGEST_USER, "-")


def _unit(deployment: Deployment, host: Host, program: Program) -> str:
    sees_devices = program.role is GATEWAY and not deployment.simulated
    teacher = TRAINER.services[0]
    settings = environment(
        deployment, host, program, "localhost", Data(f"{STATE}/{teacher}", f"{STATE}/{program.name}")
    )
    command = f"python -m {program.module}" if program.role else f"actum router --config {INSTALLED}/{ROUTER_FILE}"
    groups = ["video"] if sees_devices else [user_of(teacher)] if program.role is CLASSIFIER else []
    return UNIT.format(
        installed=INSTALLED,
        settings=SETTINGS,
        about=program.about,
        user=user_of(program.name),
        own_settings=own_settings(program),
        supplementary="".join(f"SupplementaryGroups={group}\n" for group in groups),
        state=STATE_FOLDER.format(name=program.name) if program.role in (*STATEFUL, TRAINER) else "",
        environment="\n".join(f'Environment="{name}={value}"' for name, value in settings.items()),
        command=f"{VENV}/bin/{command}",
        devices="" if sees_devices else "PrivateDevices=yes\n",
        memory_mb=program.memory_mb,
        tasks=MOST_TASKS,
    )
