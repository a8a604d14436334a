"""Units of systemd, for hosts without containers: what runs there, as closed as services can be."""

from actum_deployer.deployment import Deployment, Host
from actum_deployer.programs import INSTALLED, SETTINGS, Data, Program, environment, programs
from actum_deployer.roles import GATEWAY

VENV = "/opt/actum"
"""Where actum is installed: a virtual environment of its own."""
DATA = Data(models="/var/lib/actum", state="/var/lib/actum/state")
"""Where services keep what they learn and have answered; systemd makes the folder theirs."""
TASKS = 256
"""Most processes and threads of a service: some tens are in use."""
UNIT = """\
# Made by 'actum deploy init'. Settings of yours belong into {installed}/{settings}.
[Unit]
Description=actum: {about}
Wants=network-online.target
After=network-online.target
StartLimitIntervalSec=0

[Service]
User=actum
{supplementary}{environment}
EnvironmentFile=-{installed}/{settings}
ExecStart={command}
Restart=always
RestartSec=1
TimeoutStopSec=10
StateDirectory=actum
NoNewPrivileges=yes
CapabilityBoundingSet=
ProtectSystem=strict
ProtectHome=yes
ProtectKernelTunables=yes
ProtectKernelModules=yes
ProtectControlGroups=yes
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


def _unit(deployment: Deployment, host: Host, program: Program) -> str:
    sees_devices = program.role is GATEWAY and not deployment.simulated
    settings = environment(deployment, host, program, "localhost", DATA)
    return UNIT.format(
        installed=INSTALLED,
        settings=SETTINGS,
        about=program.about,
        supplementary="SupplementaryGroups=video\n" if sees_devices else "",
        environment="\n".join(f'Environment="{name}={value}"' for name, value in settings.items()),
        command=_command(program),
        devices="" if sees_devices else "PrivateDevices=yes\n",
        memory_mb=program.memory_mb,
        tasks=TASKS,
    )


def _command(program: Program) -> str:
    if program.role is None:
        return f"{VENV}/bin/actum router --config {INSTALLED}/router.json5"
    return f"{VENV}/bin/python -m {program.module}"
