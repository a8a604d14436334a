"""What runs on a host: the router and a program for each role, with what containers and units share."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from actum.settings import PROCESS_ENVIRONMENT
from actum_deployer.credential_folders import CREDENTIALS
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import Host
from actum_deployer.roles import (
    BODIES_BRIDGE,
    BRIDGE,
    CLASSIFIER,
    FUSION,
    GATEWAY,
    PAGE,
    ROUTER,
    TRAINER,
    Role,
    identity,
)

INSTALLED = "/etc/actum"
"""Where a host's folder is found, in containers and by systemd."""
FILES = "files"
"""The folder, in that of a host, for what is the user's own: pose model, calibration, scene file."""
SETTINGS = "settings.env"
"""The file, in that of a host, of the user's own settings, which all programs of the host get."""
ROUTER_FILE = "router.json5"
"""The file, in that of a host, of its router's configuration."""
SIMULATOR = "scene_simulator"
"""The program that stands in the place of a gateway."""
COMMAND_IMAGE = "actum/actum_command"
"""The image with all programs, in which router and trainer run."""
PAGE_PORT = 8080
"""The port of the first sensor's page; of another the next one."""
MEMORY_MB = {GATEWAY.name: 3072, TRAINER.name: 4096}
"""Memory that a program may use (MB): pose estimation takes more than others, and so does training."""
USUAL_MEMORY_MB = 512
"""The same of all others, which take a fifth of it."""
MOST_TASKS = 256
"""Most processes and threads of a program: some tens are in use."""

STATEFUL = (CLASSIFIER, FUSION)
"""The roles of services that keep what they have answered."""


@dataclass(frozen=True)
class Data:
    """The folders of what learns and classifies, and of what a service has answered, which is its own."""

    models: str
    state: str


@dataclass(frozen=True)
class Program:
    """A process of a host.

    Attributes:
        name: of container and unit.
        about: what it is.
        module: the Python module to run.
        image: the container's.
        role: whose it is; None for the router.
        sensor: the sensor that it is for, or several, such as `left,right`; empty for the router.
        credentials: the folder below `INSTALLED` with its credentials; empty where nobody is asked for any.
        memory_mb: how much it may use.
        page_port: the page's port; 0 for others.
        environment: its settings but for those that depend on where it runs.
    """

    name: str
    about: str
    module: str
    image: str
    role: Role | None
    sensor: str
    credentials: str
    memory_mb: int = USUAL_MEMORY_MB
    page_port: int = 0
    environment: Mapping[str, str] = field(default_factory=dict)


def programs(deployment: Deployment, host: Host) -> Iterator[Program]:
    """Yield what runs on a host, the router first. Where bodies come from ROS 2, no gateway publishes skeletons."""
    if host in deployment.routers:
        credentials = f"{INSTALLED}/{CREDENTIALS}/{ROUTER}" if deployment.secured else ""
        yield Program(ROUTER, "the router", "actum_command", COMMAND_IMAGE, None, "", credentials)
    for role, sensor in deployment.roles_of(host):
        if role is GATEWAY and deployment.ros_bodies is not None:
            continue
        yield _program(deployment, host, role, sensor)


def environment(deployment: Deployment, host: Host, program: Program, own_router: str, data: Data) -> dict[str, str]:
    """Return the settings of a program, where its host's router is called `own_router` and it keeps its data so."""
    router = f"{own_router}:{host.port}" if host in deployment.routers else deployment.routers[0].endpoint
    own = {"ACTUM_CONNECT": f"{deployment.transport}/{router}", **program.environment}
    if program.credentials:
        own["ACTUM_CREDENTIALS"] = program.credentials
    if program.role in (CLASSIFIER, TRAINER):
        own["ACTUM_MODEL"] = f"{data.models}/in-use.npz"
    if program.role is TRAINER:
        own["ACTUM_ORIGINAL_MODEL"] = f"{data.models}/model.npz"
        own["ACTUM_TRAINER_DATA"] = f"{data.models}/teaching"
    if program.role in STATEFUL:
        own["ACTUM_STATE"] = data.state
    if program.role in (BRIDGE, BODIES_BRIDGE):
        own["ACTUM_ROS_DOMAIN_ID"] = str(deployment.ros_domain)
    if program.role is BODIES_BRIDGE and deployment.ros_bodies is not None:
        own |= {"ACTUM_ROS_BODIES": "true", "ACTUM_ROS_FRAME_ID": deployment.ros_bodies}
    if program.page_port:
        own["ACTUM_PAGE_PORT"] = str(program.page_port)
    return own


def own_settings(program: Program) -> str:
    """Return the name of the file of the user's settings that one program alone gets, such as the page's token."""
    return f"{program.name}.env"


def suffix(host: Host, sensor: str) -> str:
    """Return what tells the programs of several sensors of a host apart; empty for a program that serves them all."""
    return f"-{sensor}" if len(host.sensors) > 1 and sensor in host.sensors else ""


def _program(deployment: Deployment, host: Host, role: Role, sensor: str) -> Program:
    service = role.services[0]
    image, module = f"actum/{service}", service
    if role is GATEWAY:
        image, module = (f"actum/{SIMULATOR}", SIMULATOR) if deployment.simulated else (f"{image}_camera", service)
    elif role is TRAINER:
        image, module = COMMAND_IMAGE, "model_trainer"
    return Program(
        name=service + suffix(host, sensor),
        about=role.about,
        module=module,
        image=image,
        role=role,
        sensor=sensor,
        credentials=f"{INSTALLED}/{CREDENTIALS}/{identity(role, sensor)}" if deployment.secured else "",
        memory_mb=MEMORY_MB.get(role.name, USUAL_MEMORY_MB),
        page_port=PAGE_PORT + host.sensors.index(sensor) if role is PAGE else 0,
        environment={"ACTUM_SENSOR": sensor, **PROCESS_ENVIRONMENT},
    )
