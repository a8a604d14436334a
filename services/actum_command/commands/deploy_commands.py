"""`actum deploy`: what the hosts of a lab need, each a folder, with credentials that their routers ask for."""

from pathlib import Path
from typing import Annotated

import typer

from actum.atomic_file import PRIVATE_FOLDER
from actum.keys import InvalidKeyError
from actum.runtime import needs_extra
from actum.settings import SettingsError
from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.terminal import fail, failing_on, say
from actum_deployer.deployment import FRAME, Deployment
from actum_deployer.hosts import hosts_of

app = PlainTyper(
    no_args_is_help=True,
    help=(
        "Write the files that are needed to run actum on several hosts: configuration files of routers and containers, "
        "systemd units and credentials."
    ),
)

DirArgument = Annotated[
    Path,
    typer.Argument(
        metavar="DIR",
        help=(
            "the folder to which 'actum deploy init' writes the files of all hosts. This folder contains private keys, "
            "so let nobody else read it"
        ),
    ),
]
YEAR = 365
"""How long certificates are valid (days) where nothing else is said."""
LEAST_DAYS = 0.01
"""How short they can be: longer than what it takes to copy them."""
MOST_DAYS = 3650
"""How long they can be: no longer than their authority."""


@app.command()
def init(  # noqa: PLR0913, PLR0917 - one parameter is one option
    folder: DirArgument,
    hosts: Annotated[
        str,
        typer.Option(
            metavar="NAME=ADDRESS,…",
            help=(
                "names and addresses of the hosts, such as camera=192.168.1.5,compute=192.168.1.6. A host whose name "
                "begins with camera runs a camera and the marker tracker. A host whose name begins with compute runs "
                "all other services, and one web page for each sensor. Name further hosts camera2, compute2 and so on. "
                "If there are several compute hosts, each sensor is assigned to one of them. If the router of a host "
                "uses another port than 7447, append :PORT to the host's address"
            ),
        ),
    ],
    sensors: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,…",
            help=(
                "names of the sensors, one for each camera host in the order of --hosts, such as door,window; default: "
                "kinect0,kinect1,…"
            ),
        ),
    ] = None,
    one_router: Annotated[
        bool,
        typer.Option(
            "--one-router", help="run a single router, on the first host of --hosts; default: one router on each host"
        ),
    ] = False,
    passwords: Annotated[
        bool,
        typer.Option(
            "--passwords",
            help="require user names and passwords in addition to certificates; default: certificates only",
        ),
    ] = False,
    images: Annotated[
        bool,
        typer.Option(
            "--images",
            help=(
                "also send camera images to other hosts. With --open, images are always sent. Default: images stay on "
                "the camera's host"
            ),
        ),
    ] = False,
    simulate: Annotated[bool, typer.Option("--simulate", help="run the simulated scene instead of cameras")] = False,
    ros2: Annotated[
        int | None,
        typer.Option(
            metavar="DOMAIN",
            min=0,
            max=232,
            help=(
                "also run the bridge to ROS 2, for ROS 2 nodes with this ROS_DOMAIN_ID (usually 0); default: no bridge"
            ),
        ),
    ] = None,
    ros_bodies: Annotated[
        str | None,
        typer.Option(
            metavar="FRAME",
            help=(
                "take skeletons not from the sensor gateway, but from ROS 2 nodes that track bodies. FRAME is the "
                "optical frame of the camera that sees the bodies. Requires --ros2 and a single camera host. Default: "
                "the sensor gateway of each camera host publishes skeletons"
            ),
        ),
    ] = None,
    not_secured: Annotated[
        bool,
        typer.Option(
            "--open", help="disable TLS, passwords and access control; use this option only on a trusted network"
        ),
    ] = False,
) -> None:
    """Write a folder of files for each host, and a folder of credentials for each role that a user can have.

    Copy each host's folder to the host, and follow the README.md in the folder. Copy the credentials of a user's role
    to the user's machine: the folder people/viewer, for example, is for users who only watch. To change the deployment,
    run the command again with other options.
    """
    if not_secured and passwords:
        fail(
            "--open and --passwords cannot be used together, because --open turns off passwords: leave out one of the "
            "two"
        )
    with failing_on(SettingsError, InvalidKeyError):
        placed = hosts_of(hosts, sensors)
    cameras = [host for host in placed if host.kind == "camera"]
    if ros_bodies is not None and (ros2 is None or simulate or len(cameras) > 1):
        fail(
            "--ros-bodies works only with --ros2, with exactly one camera host and without --simulate: add --ros2, "
            "name only one camera host in --hosts, and leave out --simulate"
        )
    if ros_bodies is not None and not FRAME.fullmatch(ros_bodies):
        fail(
            f"--ros-bodies {ros_bodies!r} is not the name of a frame: use at most 200 letters, digits, '_', '.', '/' "
            "and '-', such as camera_color_optical_frame"
        )
    with failing_on(SettingsError, OSError), needs_extra("deploy"):
        from actum_deployer.writing import alone, revoked_before, write_deployment

        folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
        with alone(folder):
            revoked = revoked_before(folder)
            deployment = Deployment(
                placed, not not_secured, passwords, images, one_router, simulate, revoked, ros2, ros_bodies
            )
            write_deployment(deployment, folder, YEAR)
    for host in placed:
        say(f"{host.name}: copy {folder / host.name} to {host.address} and follow its README.md there")
    if deployment.secured:
        say(
            f"people: copy a folder of {folder / 'people'} to a person's machine and name it in ACTUM_CREDENTIALS: "
            f"ACTUM_CONNECT=tls/{placed[0].endpoint} ACTUM_CREDENTIALS=…/viewer actum watch"
        )
        say(f"keep {folder / 'authority'} private: its key signs credentials", style="yellow")


@app.command()
def rotate(
    folder: DirArgument,
    days: Annotated[
        float,
        typer.Option(min=LEAST_DAYS, max=MOST_DAYS, help="number of days for which the new certificates are valid"),
    ] = YEAR,
    revoke: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help=(
                "name of a folder of credentials that were lost or stolen, such as viewer. The routers will refuse the "
                "old certificate of this folder. The option can be repeated. Default: no certificate is refused"
            ),
        ),
    ] = None,
) -> None:
    """Renew all certificates and keys, before they expire or after some were lost or stolen.

    If credentials were lost or stolen, name their folder with --revoke, so that the routers refuse the old certificate.
    Afterwards, copy the new files: to each host, the folder credentials/ that was written for this host; to each user's
    machine, the user's folder from people/. Services read the new certificates without a restart. Only if you used
    --revoke, also copy router.json5 to each host. Then restart each router that runs in a container or is 'zenohd'.
    """
    with failing_on(SettingsError, OSError), needs_extra("deploy"):
        from actum_deployer.writing import alone, write_deployment

        Deployment.load(folder)  # else a folder that holds none would get a file
        with alone(folder):
            deployment = Deployment.load(folder).revoking(revoke or [])
            if not deployment.secured:
                fail(
                    f"the deployment in {folder} was made with --open, so it has no credentials to renew: to get "
                    "credentials, run 'actum deploy init' without --open"
                )
            write_deployment(deployment, folder, days, may_be_new=False)
    names = ", ".join(host.name for host in deployment.hosts)
    say(f"copy credentials/ and router.json5 of {names}, and the folders of people/, to their machines again")
    if revoke:
        say(
            "the credentials are revoked once every host has its new router.json5; for a router in a container, "
            "run: docker compose restart router"
        )
