"""`actum models`: the pose model that the camera needs."""

import hashlib
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from http.client import HTTPException
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TransferSpeedColumn

from actum.atomic_file import replaced
from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.terminal import errors, failing_on, refuse_ending, say
from sensor_gateway.settings import default_pose_model

CHUNK_BYTES = 64 * 1024  # small enough that progress moves on a slow line, large enough that it costs nothing
TIMEOUT_S = 30.0  # a server that sends nothing for so long is given up


class FetchError(ValueError):
    """A file that could not be fetched; the text names it, the reason and what to do."""


@dataclass(frozen=True)
class Published:
    """A published file: its address, size (bytes) and SHA-256 (hexadecimal)."""

    url: str
    size: int
    sha256: str


POSE_MODEL = Published(
    url="https://storage.googleapis.com/mediapipe-models/pose_landmarker/pose_landmarker_full/float16/1/"
    "pose_landmarker_full.task",
    size=9_398_198,
    sha256="5134a3aad27a58b93da0088d431f366da362b44e3ccfbe3462b3827a839011b1",
)
"""MediaPipe's full pose landmarker, revision 1, Apache-2.0."""

app = PlainTyper(
    no_args_is_help=True,
    help="Download the model that finds people in camera images. Download this model before you use a camera.",
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
            help="the file to write (.task). Default: the file from which the sensor gateway reads the model",
        ),
    ] = None,
    url: Annotated[
        str,
        typer.Option(
            help=(
                "address from which to download the file, such as the address of a mirror; default: the original "
                "address. The command checks that the downloaded file has the checksum of the original file"
            )
        ),
    ] = POSE_MODEL.url,
) -> None:
    """Download MediaPipe's pose model (9 MB, Apache-2.0), and check that the file is complete and unchanged.

    Download the model once, before you use a camera.
    """
    if output is not None:
        refuse_ending(output, ".task")
    path = output or default_pose_model()
    published = replace(POSE_MODEL, url=url)
    if path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == published.sha256:
        say(f"the pose model is already at {path}")
        return
    columns = TextColumn("fetching"), BarColumn(), DownloadColumn(), TransferSpeedColumn()
    with failing_on(FetchError, OSError), Progress(*columns, console=errors, transient=True) as progress:
        task = progress.add_task("fetching", total=published.size)
        fetch(published, path, lambda done: progress.update(task, completed=done))
    say(f"downloaded and verified: {path}")
    if output is not None:
        say(f"to use it, set this for the gateway: ACTUM_POSE_MODEL={path}")


def fetch(published: Published, path: Path, progress: Callable[[int], None]) -> None:
    """Fetch a file to a path; an existing one is replaced only once the new one is complete and checked.

    `progress` is called after each chunk with the number of bytes received.

    Raises:
        FetchError: it cannot be reached, or its size or digest is another.
        OSError: it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    digest, size = hashlib.sha256(), 0
    with replaced(path) as file:
        for chunk in _chunks(published.url):
            file.write(chunk)
            digest.update(chunk)
            size += len(chunk)
            if size > published.size:
                break
            progress(size)
        if size < published.size:
            raise FetchError(f"{published.url}: the download stopped after {size} of {published.size} bytes: try again")
        if size > published.size or digest.hexdigest() != published.sha256:
            raise FetchError(
                f"the file downloaded from {published.url} is not the published one (SHA-256 {digest.hexdigest()}, "
                f"expected {published.sha256}) and was deleted: check the proxy, and try again"
            )


def _chunks(url: str) -> Iterator[bytes]:
    if not url.startswith(("http://", "https://")):
        raise FetchError(f"{url} does not begin with http:// or https://: use an address that does")
    try:
        with urllib.request.urlopen(url, timeout=TIMEOUT_S) as answer:
            while chunk := answer.read(CHUNK_BYTES):
                yield chunk
    except urllib.error.HTTPError as error:
        raise FetchError(
            f"{url} cannot be downloaded, because the server answers {error.code} {error.reason}: try again later"
        ) from None
    except (OSError, HTTPException, ValueError) as error:
        reason = getattr(error, "reason", None) or error
        raise FetchError(f"{url} cannot be reached ({reason}): check the network and the proxy") from None
