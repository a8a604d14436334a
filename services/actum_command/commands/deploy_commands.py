"""`actum deploy`: what the hosts of a lab need, each a folder, with credentials that their routers ask for."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from actum.atomic_file import PRIVATE_FOLDER
from actum.keys import InvalidKeyError
from actum.runtime import needs_extra
from actum.settings import SettingsError
from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.terminal import fail, say
from actum_deployer.deployment import Deployment, Host, hosts_of

app = PlainTyper(
    no_args_is_help=True,
    help="Write and renew the files that each host of a deployment needs: compose file, router, units, credentials.",
)

DirArgument = Annotated[
    Path, typer.Argument(metavar="DIR", help="the deployment's folder, which has to be kept private")
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
                "the hosts, as camera=ADDRESS,compute=ADDRESS; further ones as camera2=…; append :PORT for another port"
            ),
        ),
    ],
    sensors: Annotated[
        str | None,
        typer.Option(metavar="NAME,…", help="the sensors' names, one per camera; default: kinect0,kinect1,…"),
    ] = None,
    one_router: Annotated[bool, typer.Option("--one-router", help="run a router on the first host only")] = False,
    passwords: Annotated[
        bool, typer.Option("--passwords", help="require user names and passwords in addition to certificates")
    ] = False,
    images: Annotated[bool, typer.Option("--images", help="allow images to leave the camera's host")] = False,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="run the simulated scene in place of the cameras")
    ] = False,
    ros2: Annotated[
        int | None,
        typer.Option(metavar="DOMAIN", min=0, max=232, help="add the bridge to ROS 2 in this domain, usually 0"),
    ] = None,
    not_secured: Annotated[
        bool, typer.Option("--open", help="disable TLS, passwords and access control; use it only on a trusted network")
    ] = False,
) -> None:
    """Write a folder for each host and one for people's programs; a later run renews them."""
    if not_secured and passwords:
        fail("--open and --passwords exclude each other: leave out one of them")
    try:
        placed = hosts_of(hosts, sensors)
    except (SettingsError, InvalidKeyError) as error:
        fail(str(error))
    with _refusing(), needs_extra("deploy"):
        from actum_deployer.writing import alone, revoked_before, write_deployment

        folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
        with alone(folder):
            revoked = revoked_before(folder)
            deployment = Deployment(placed, not not_secured, passwords, images, one_router, simulate, revoked, ros2)
            write_deployment(deployment, folder, YEAR)
    for host in placed:
        say(f"{host.name}: copy {folder / host.name} to {host.address} and follow its README.md there")
    if deployment.secured:
        say(
            f"people: copy a folder of {folder / 'people'} to a person's machine and name it in ACTUM_CREDENTIALS: "
            f"{_example(placed[0])}"
        )
        say(f"keep {folder / 'authority'} private: its key signs credentials", style="yellow")


@app.command()
def rotate(
    folder: DirArgument,
    days: Annotated[
        float, typer.Option(min=LEAST_DAYS, max=MOST_DAYS, help="time for which the new credentials are valid (days)")
    ] = YEAR,
    revoke: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="make routers refuse the old credentials of this folder, such as viewer"),
    ] = None,
) -> None:
    """Renew all certificates and their keys; after copying, services use them without a restart.

    Run with --revoke NAME once for each folder of credentials that was lost or stolen. Routers refuse the old
    certificate as soon as they have their new router.json5.
    """
    with _refusing(), needs_extra("deploy"):
        from actum_deployer.writing import alone, write_deployment

        Deployment.load(folder)  # else a folder that holds none would get a file
        with alone(folder):
            deployment = Deployment.load(folder).revoking(revoke or [])
            if not deployment.secured:
                fail(f"{folder} was made with --open, so it has no credentials to renew")
            write_deployment(deployment, folder, days, may_be_new=False)
    names = ", ".join(host.name for host in deployment.hosts)
    say(f"copy credentials/ and router.json5 of {names}, and the folders of people/, to their machines again")
    if revoke:
        say(
            "the credentials are revoked once every host has its new router.json5; for a router in a container, "
            "run: docker compose restart router"
        )


@contextmanager
def _refusing() -> Iterator[None]:
    """Return a context that ends the command with the reason where something cannot be done."""
    try:
        yield
    except (SettingsError, OSError) as error:
        fail(str(error))


def _example(host: Host) -> str:
    return f"ACTUM_CONNECT=tls/{host.endpoint} ACTUM_CREDENTIALS=…/viewer actum watch"
