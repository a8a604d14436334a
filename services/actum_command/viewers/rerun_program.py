"""Runs the Rerun viewer, bound to this machine, and sends it messages; or writes them to a file of Rerun's.

Rerun's server refuses pages of other origins, but not names that are made to point to it (DNS rebinding): a website
that guesses its address may read it. So it is served on a loopback address that nobody can guess.
"""

import os
import secrets
import socket
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

import numpy as np
import rerun as rr
import rerun_cli

from actum.messages import Message
from actum_command.supervising import stop_processes
from actum_command.viewers.rerun_entries import TIMELINE, RerunEntries, layout

LOCAL = "127.0.0.1"
"""What is served where a system has no other loopback addresses, as macOS."""
START_S = 30.0
"""How long (s) the program may take to listen: it is read from disk, 150 MB."""
POLL_S = 0.05
"""Interval (s) at which it is looked for."""
FLUSH_S = 10.0
"""How long (s) what was sent last may take to arrive."""
QUIET = {"CI": "1", "RUST_LOG": "warn"}
"""Rerun's program collects no usage data where it takes itself for one on a build server; no notes, only warnings."""


class ViewerError(RuntimeError):
    """The viewer cannot be started; the text says why and what to do."""


class RerunStream:
    """Sends messages to a viewer, or to a file."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        self._recording = recording
        self._entries = RerunEntries()

    def show(self, message: Message) -> None:
        """Send one message, at its stamp."""
        self._recording.set_time(TIMELINE, timestamp=np.datetime64(message.stamp_ns, "ns"))
        for entry in self._entries.of(message):
            self._recording.log(entry.path, *entry.shown, static=entry.static)


@contextmanager
def saved(path: Path, sensors: Sequence[str]) -> Iterator[RerunStream]:
    """Return a context in which messages are written to a file that Rerun opens."""
    path.parent.mkdir(parents=True, exist_ok=True)
    recording = rr.RecordingStream("actum")
    recording.save(path, default_blueprint=layout(sensors))
    try:
        yield RerunStream(recording)
    finally:
        recording.disconnect()


@contextmanager
def viewer(
    sensors: Sequence[str], address: str, port: int, web_port: int | None, ended: threading.Event
) -> Iterator[RerunStream]:
    """Return a context in which Rerun's program runs: its window, or with `web_port` a page. `ended` is set with it.

    Only `address` is served: by default Rerun's own functions and program serve all the machine's.

    Raises:
        ViewerError: a port is taken, or the program ends at once.
    """
    with _running(address, port, web_port) as process:
        threading.Thread(target=_tell_end, args=(process, ended), daemon=True).start()
        recording = rr.RecordingStream("actum")
        recording.connect_grpc(proxy(address, port), default_blueprint=layout(sensors))
        try:
            yield RerunStream(recording)
        finally:
            if process.poll() is None:
                recording.flush(timeout_sec=FLUSH_S)
            recording.disconnect()


@contextmanager
def _running(address: str, port: int, web_port: int | None) -> Iterator["subprocess.Popen[bytes]"]:
    """Run the program, bound to an address, from when it listens."""
    own_page = ["--cors-allow-origin", f"http://{address}:{web_port}"]
    page_options = [] if web_port is None else ["--serve-web", "--web-viewer-port", str(web_port), *own_page]
    ports = [port] if web_port is None else [port, web_port]
    for number in ports:
        if _is_listened_on(address, number):
            raise ViewerError(
                f"port {number} is already in use: stop the program that listens on this port, or choose another port "
                "with --port or --web-port"
            )
    process = subprocess.Popen(
        [_program(), "--bind", address, "--port", str(port), "--expect-data-soon", *page_options],
        env={**os.environ, **QUIET},
        stdin=subprocess.DEVNULL,
    )
    try:
        _wait_until_listening(process, address, ports)
        yield process
    finally:
        stop_processes([process])


def own_address() -> str:
    """Return a loopback address that no website can guess: one of sixteen million, where the system has them."""
    address = ".".join(["127", *(str(1 + secrets.randbelow(254)) for _ in range(3))])
    with socket.socket() as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return LOCAL
    return address


def proxy(address: str, port: int) -> str:
    """Return where the program takes data."""
    return f"rerun+http://{address}:{port}/proxy"


def page(address: str, port: int, web_port: int) -> str:
    """Return the address of the page that shows the data."""
    return f"http://{address}:{web_port}/?url={quote(proxy(address, port), safe='')}"


def _program() -> Path:
    """Return the program itself: the script `rerun` starts it as a child, which would outlive a stopped script."""
    folder = Path(rerun_cli.__file__).parent
    names = ("Rerun.app/Contents/MacOS/Rerun", "rerun", "rerun.exe")
    return next(folder / name for name in names if (folder / name).exists())


def _is_listened_on(address: str, port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex((address, port)) == 0


def _wait_until_listening(process: "subprocess.Popen[bytes]", address: str, ports: Sequence[int]) -> None:
    deadline_s = time.monotonic() + START_S
    while not all(_is_listened_on(address, port) for port in ports):
        if process.poll() is not None:
            raise ViewerError(
                f"the Rerun viewer ended at once (code {process.returncode}): if this machine has no screen, use --web"
            )
        if time.monotonic() > deadline_s:
            raise ViewerError(
                f"the Rerun viewer did not listen on port {' and '.join(map(str, ports))} within {START_S:g} s: try "
                "again"
            )
        time.sleep(POLL_S)


def _tell_end(process: subprocess.Popen[bytes], ended: threading.Event) -> None:
    process.wait()
    ended.set()
