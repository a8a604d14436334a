"""The pose model is fetched whole and right, or not at all."""

import hashlib
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from actum_command.commands import pose_model_commands
from actum_command.commands.pose_model_commands import FetchError, Published, fetch
from command_lines import invoke

CONTENT = bytes(range(256)) * 1000


@contextmanager
def serving(content: bytes, announced: int | None = None, status: int = 200) -> Iterator[str]:
    """Serve one file, and announce as many bytes as told."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(status)
            self.send_header("Content-Length", str(len(content) if announced is None else announced))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/pose.task"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def published(url: str, content: bytes = CONTENT) -> Published:
    return Published(url, len(content), hashlib.sha256(content).hexdigest())


def nothing(_done: int) -> None:
    pass


def test_a_right_file_is_written_with_progress(tmp_path: Path) -> None:
    told: list[int] = []
    with serving(CONTENT) as url:
        fetch(published(url), tmp_path / "new" / "pose.task", told.append)
    assert (tmp_path / "new" / "pose.task").read_bytes() == CONTENT
    assert told == sorted({*told})
    assert told[-1] == len(CONTENT) and len(told) > 2


@pytest.mark.parametrize("announced", [None, len(CONTENT)], ids=["as if whole", "the connection breaks off"])
def test_a_file_that_breaks_off_is_not_kept(tmp_path: Path, announced: int | None) -> None:
    with serving(CONTENT[:100_000], announced) as url, pytest.raises(FetchError, match="stopped|cannot be reached"):
        fetch(published(url), tmp_path / "pose.task", nothing)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [CONTENT[:-1] + b"!", CONTENT + b"!"], ids=["another byte", "a byte more"])
def test_a_file_with_another_digest_is_not_kept_and_the_old_one_stays(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "pose.task"
    path.write_bytes(b"old")
    with serving(content) as url, pytest.raises(FetchError, match="is not the published one"):
        fetch(published(url), path, nothing)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_server_without_the_file_is_told(tmp_path: Path) -> None:
    with serving(b"", status=404) as url, pytest.raises(FetchError, match="the server answers 404"):
        fetch(published(url), tmp_path / "pose.task", nothing)


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("http://127.0.0.1:9/pose.task", "cannot be reached"),
        ("http://[pose.task", "cannot be reached"),
        ("file:///pose.task", "does not begin with http"),
    ],
    ids=["nobody there", "no address", "not the web"],
)
def test_an_address_that_cannot_be_used_is_told(tmp_path: Path, url: str, said: str) -> None:
    with pytest.raises(FetchError, match=said):
        fetch(published(url), tmp_path / "pose.task", nothing)


def test_the_command_writes_where_the_gateway_looks_and_fetches_nothing_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr("sys.platform", "linux")
    with serving(CONTENT) as url:
        monkeypatch.setattr(pose_model_commands, "POSE_MODEL", published(url))
        first = invoke("models", "fetch", "--url", url)
    assert first.exit_code == 0, first.output
    assert (tmp_path / "actum" / "pose_landmarker_full.task").read_bytes() == CONTENT
    again = invoke("models", "fetch", "--url", url)
    assert again.exit_code == 0
    assert "already" in again.output


def test_the_command_fails_with_what_went_wrong(tmp_path: Path) -> None:
    with serving(CONTENT) as url:
        failed = invoke("models", "fetch", "--url", url, "-o", tmp_path / "pose.task")
    assert failed.exit_code == 1
    assert "the download stopped" in " ".join(failed.stderr.split())
