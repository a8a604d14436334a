"""`actum models`: the pose model that the camera needs."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TransferSpeedColumn

from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.terminal import errors, fail, refuse_ending, say
from actum_command.model_download import POSE_MODEL, FetchError, Published, fetch
from sensor_gateway.settings import default_pose_model

app = PlainTyper(
    no_args_is_help=True,
    help="Download the model that finds people in camera images. Do this before you use a camera.",
)


@app.callback()
def _models() -> None:
    """Make `fetch` a command of its own, though it is the only one."""


@app.command("fetch")
def fetch_command(
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="the file to write (.task); default: the file from which the sensor gateway reads the model",
        ),
    ] = None,
    url: Annotated[
        str,
        typer.Option(
            help=(
                "address to download from, such as that of a mirror; the checksum of the file is compared with that of "
                "the original"
            )
        ),
    ] = POSE_MODEL.url,
) -> None:
    """Download MediaPipe's pose model (9 MB, Apache-2.0) and check that the file is the expected one.

    Do this once, before you use a camera.
    """
    if output is not None:
        refuse_ending(output, ".task")
    path = output or default_pose_model()
    published = replace(POSE_MODEL, url=url)
    if published.is_at(path):
        say(f"the pose model is already at {path}")
        return
    try:
        _fetch(published, path)
    except (FetchError, OSError) as error:
        fail(str(error))
    say(f"downloaded and verified: {path}")
    if output is not None:
        say(f"to use it, set this for the gateway: ACTUM_POSE_MODEL={path}")


def _fetch(published: Published, path: Path) -> None:
    columns = TextColumn("fetching"), BarColumn(), DownloadColumn(), TransferSpeedColumn()
    with Progress(*columns, console=errors, transient=True) as progress:
        task = progress.add_task("fetching", total=published.size)
        fetch(published, path, lambda done, _total: progress.update(task, completed=done))
