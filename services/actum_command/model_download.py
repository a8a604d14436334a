"""Downloads a published file, such as the pose model, and checks its digest before it gets its name."""

import hashlib
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http.client import HTTPException
from pathlib import Path
from typing import BinaryIO

from actum.atomic_file import replaced

CHUNK_BYTES = 64 * 1024  # small enough that progress moves on a slow line, large enough that it costs nothing
TIMEOUT_S = 30.0  # a server that sends nothing for so long is given up
Progress = Callable[[int, int], None]
"""Called after each chunk with the number of bytes received, and of all."""


class FetchError(ValueError):
    """A file that could not be fetched; the text names it, the reason and what to do."""


@dataclass(frozen=True)
class Published:
    """A published file: its address, size (bytes) and SHA-256 (hexadecimal)."""

    url: str
    size: int
    sha256: str

    def is_at(self, path: Path) -> bool:
        """Tell whether the file at a path has this one's digest."""
        return path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == self.sha256


POSE_MODEL = Published(
    url="https://storage.googleapis.com/mediapipe-models/pose_landmarker/pose_landmarker_full/float16/1/"
    "pose_landmarker_full.task",
    size=9_398_198,
    sha256="5134a3aad27a58b93da0088d431f366da362b44e3ccfbe3462b3827a839011b1",
)
"""MediaPipe's full pose landmarker, revision 1, Apache-2.0."""


def fetch(published: Published, path: Path, progress: Progress) -> None:
    """Fetch a file to a path; an existing one is replaced only once the new one is complete and checked.

    Raises:
        FetchError: it cannot be reached, or its size or digest is another.
        OSError: it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as file:
        _check(published, *_received(published, file, progress))


def _received(published: Published, file: BinaryIO, progress: Progress) -> tuple[int, str]:
    """Download to a file, and return its size and SHA-256."""
    digest, size = hashlib.sha256(), 0
    for chunk in _chunks(published.url):
        file.write(chunk)
        digest.update(chunk)
        size += len(chunk)
        if size > published.size:
            break
        progress(size, published.size)
    return size, digest.hexdigest()


def _chunks(url: str) -> Iterator[bytes]:
    if not url.startswith(("http://", "https://")):
        raise FetchError(f"{url} does not begin with http:// or https://: use such an address")
    try:
        with urllib.request.urlopen(url, timeout=TIMEOUT_S) as answer:
            while chunk := answer.read(CHUNK_BYTES):
                yield chunk
    except urllib.error.HTTPError as error:
        raise FetchError(f"{url}: the server answers {error.code} {error.reason}; try again later") from None
    except (OSError, HTTPException, ValueError) as error:
        reason = getattr(error, "reason", None) or error
        raise FetchError(f"{url} cannot be reached ({reason}): check the network and the proxy") from None


def _check(published: Published, size: int, sha256: str) -> None:
    if size < published.size:
        raise FetchError(f"{published.url}: the download stopped after {size} of {published.size} bytes; try again")
    if size > published.size or sha256 != published.sha256:
        raise FetchError(
            f"the file downloaded from {published.url} is not the published one (SHA-256 {sha256}, expected "
            f"{published.sha256}) and was deleted: check the proxy, and try again"
        )
