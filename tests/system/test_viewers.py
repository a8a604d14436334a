"""Live streams, and recordings, in Rerun and in Foxglove: real processes, read by clients of those sides."""

import asyncio
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import psutil
import pytest

from actum.installing import install_command
from actum.messages import Truth
from actum.recorder import Recorder
from actum_command.scene_marks import mark_of
from live import PATIENCE_S, Running, System, free_port, started, wait_until
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator

pytestmark = pytest.mark.system
needs_rerun = pytest.mark.skipif(not find_spec("rerun"), reason="rerun-sdk is not installed: pip install -e '.[view]'")
needs_foxglove = pytest.mark.skipif(
    not find_spec("foxglove") or not find_spec("websockets"),
    reason="foxglove-sdk or websockets is not installed: pip install -e '.[dev]'",
)
SUBPROTOCOL = "foxglove.sdk.v1"
MESSAGE = struct.Struct("<BIQ")
"""The head of a message: 1, the subscription, and the log time (ns)."""
SCENE = ("--seed", "1", "--image-hz", "15")
START_NS = 1_700_000_000_000_000_000


def start_scene(running: System) -> None:
    running.start_router()
    running.start("scene_simulator", *SCENE)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A recording of three seconds of the simulated scene, with images and marks."""
    simulator = Simulator(balanced_programme(1, 1), 0, 1, image_hz=15, start_ns=START_NS)
    with Recorder(tmp_path / "scene.mcap", person="simulated 0", source="simulator") as recorder:
        for _, messages in zip(range(90), simulator.frames(), strict=False):
            for message in messages:
                recorder.write(message)
                if isinstance(message, Truth):
                    recorder.write(mark_of(message))
    return tmp_path / "scene.mcap"


def listening_on(port: int) -> set[str]:
    """Return the addresses on which a port is listened on."""
    sockets = [each.laddr for each in psutil.net_connections("tcp") if each.status == psutil.CONN_LISTEN]
    return {address.ip for address in sockets if address.port == port}


def may_read(address: str, port: int, origin: str) -> bool:
    """Tell whether Rerun's server lets scripts of an origin read what it answers."""
    asked = {"Origin": origin, "Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "x-grpc-web"}
    method = "/rerun.sdk_comms.v1alpha1.MessageProxyService/ReadMessages"
    with urlopen(Request(f"http://{address}:{port}{method}", headers=asked, method="OPTIONS")) as answer:
        return answer.headers["access-control-allow-origin"] in (origin, "*")


async def heard(
    address: str, enough: Callable[[dict[str, list[Any]]], bool], origin: str | None = None
) -> dict[str, list[Any]]:
    """Subscribe to everything that a server advertises; return their messages by topic."""
    from websockets.asyncio.client import connect

    topics: dict[int, dict[str, Any]] = {}
    found: dict[str, list[Any]] = {}
    options: Any = {"subprotocols": [SUBPROTOCOL], "max_size": None, "origin": origin}
    async with connect(address, **options) as client, asyncio.timeout(PATIENCE_S):
        while not enough(found):
            sent = await client.recv()
            if isinstance(sent, str):
                advertised = json.loads(sent)
                for channel in advertised.get("channels", []):
                    topics[channel["id"]] = channel
                    asked = {"op": "subscribe", "subscriptions": [{"id": channel["id"], "channelId": channel["id"]}]}
                    await client.send(json.dumps(asked))
            elif sent[0] == 1:
                _, subscription, log_time_ns = MESSAGE.unpack_from(sent)
                channel = topics[subscription]
                found.setdefault(channel["topic"], []).append((log_time_ns, channel, sent[MESSAGE.size :]))
    return found


def address_of(serving: Running) -> str:
    wait_until(lambda: "ws://" in serving.said(), "the server tells its address")
    return re.search(r"ws://[\d.]+:\d+", serving.said())[0]  # type: ignore[index]


def listen(client: Coroutine[Any, Any, dict[str, list[Any]]]) -> dict[str, list[Any]]:
    """Run a client in a thread of its own: where a browser was tested before, this one's event loop is taken."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, client).result()


@needs_foxglove
def test_foxglove_is_served_the_live_scene_on_this_machine_only(running: System) -> None:
    start_scene(running)
    serving = running.start("actum_command", "foxglove", "--port", "0")
    address = address_of(serving)
    wanted = {"/tf", "/actum/kinect0/skeleton", "/actum/kinect0/image/color", "/actum/kinect0/truth"}
    found = listen(heard(address, lambda found: set(found) >= wanted))
    encodings = {topic: (channel["encoding"], channel["schemaName"]) for topic, [(_, channel, _), *_] in found.items()}
    assert encodings["/tf"] == ("protobuf", "foxglove.FrameTransforms")
    assert encodings["/actum/kinect0/skeleton"] == ("protobuf", "foxglove.SceneUpdate")
    assert encodings["/actum/kinect0/image/color"] == ("protobuf", "foxglove.CompressedImage")
    assert encodings["/actum/kinect0/truth"] == ("json", "actum.truth/1")
    log_time_ns, _, truth = found["/actum/kinect0/truth"][0]
    assert json.loads(truth)["stamp_ns"] == log_time_ns
    assert listening_on(int(address.rpartition(":")[2])) == {"127.0.0.1"}
    for _ in range(2):
        with pytest.raises(Exception, match="HTTP 403"):
            listen(heard(address, bool, origin="https://app.foxglove.dev"))
    serving.terminate()
    refusal = "refused: a page of 'https://app.foxglove.dev' may not come in here: use --origin to admit it"
    assert serving.said().count(refusal) == 1
    assert re.search(r"\d+ messages served", serving.said())


@pytest.mark.thorough
@needs_foxglove
def test_a_recording_is_played_from_its_start_once_somebody_subscribes(running: System, scene: Path) -> None:
    serving = running.start("actum_command", "foxglove", "--port", "0", "--speed", "20", str(scene))
    skeletons = "/actum/kinect0/skeleton"
    found = listen(heard(address_of(serving), lambda found: skeletons in found))
    assert found[skeletons][0][0] < START_NS + 10**9
    serving.process.wait(timeout=PATIENCE_S)
    assert serving.process.returncode == 0


@needs_foxglove
def test_a_taken_port_is_told_of(running: System, scene: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        refused = running.actum("foxglove", "--port", str(port), str(scene))
    assert refused.returncode == 1
    assert "choose another --port" in refused.stderr


@needs_foxglove
def test_an_exported_recording_has_foxgloves_schemas_and_every_message(running: System, scene: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    protobuf = pytest.importorskip(
        "mcap_protobuf.decoder", reason="mcap-protobuf-support is not installed: pip install -e '.[dev]'"
    )
    output = scene.with_name("foxglove.mcap")
    exported = running.actum("export", str(scene), str(output), "--foxglove")
    assert exported.returncode == 0, exported.stderr
    kinds: Counter[str] = Counter()
    with output.open("rb") as file:
        for schema, channel, message in reader.make_reader(file).iter_messages():
            kinds[schema.name] += 1
            if channel.message_encoding == "protobuf":
                assert protobuf.DecoderFactory().decoder_for("protobuf", schema)(message.data) is not None
    assert kinds["foxglove.CompressedImage"] == kinds["foxglove.CameraCalibration"] == 45
    assert kinds["actum.truth/1"] == kinds["actum.segment/1"] > 0
    again = running.actum("export", str(scene), str(output), "--foxglove")
    assert (again.returncode, "already exists" in again.stderr) == (1, True)


@needs_rerun
def test_rerun_verifies_and_reads_what_was_written_of_the_live_scene(running: System, tmp_path: Path) -> None:
    from rerun.chunk import RrdReader

    start_scene(running)
    output = tmp_path / "live.rrd"
    viewing = running.start("actum_command", "view", "-o", str(output))
    wait_until(lambda: output.exists() and output.stat().st_size > 200_000, "a part of the scene is written")
    viewing.terminate()
    assert "messages written" in viewing.said()
    program = [sys.executable, "-m", "rerun_cli", "rrd", "verify", str(output)]
    verified = subprocess.run(program, capture_output=True, text=True, check=True)
    assert "verified without error" in verified.stderr + verified.stdout
    rows = Counter[str]()
    for chunk in RrdReader(output).stream():
        rows[chunk.entity_path] += chunk.num_rows
    assert rows["/kinect0/people/1/bones"] > 10
    assert rows["/kinect0/image/color"] > 5


@needs_rerun
def test_rerun_is_served_at_a_loopback_address_nobody_guesses_without_usage_data_and_leaves_nothing(
    running: System, scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    port, web_port = free_port(), free_port()
    ports = ("--port", str(port), "--web-port", str(web_port))
    viewing = running.start("actum_command", "view", "--web", *ports, str(scene))
    wait_until(lambda: "messages sent to Rerun" in viewing.said(), "the recording is sent")
    [address] = listening_on(port)
    assert address.startswith("127.") and address != "127.0.0.1"
    assert listening_on(web_port) == {address}
    assert f"http://{address}:{web_port}/?url=rerun%2Bhttp%3A%2F%2F{address}%3A{port}%2Fproxy" in viewing.said()
    with urlopen(f"http://{address}:{web_port}/") as page:
        assert b"rerun" in page.read().lower()
    assert may_read(address, port, f"http://{address}:{web_port}")
    assert not may_read(address, port, "http://evil.example")
    viewing.terminate()
    assert viewing.process.returncode == 0
    assert listening_on(port) == listening_on(web_port) == set()
    assert [file for file in (tmp_path / "home").rglob("*analytics*") if file.is_file()] == []


@needs_rerun
def test_the_end_of_the_viewer_ends_the_command(running: System) -> None:
    start_scene(running)
    ports = ("--port", str(free_port()), "--web-port", str(free_port()))
    viewing = running.start("actum_command", "view", "--web", *ports)
    wait_until(lambda: "open http" in viewing.said(), "the page is served")
    tasks = Path(f"/proc/{viewing.process.pid}/task")
    [viewer] = {pid for children in tasks.glob("*/children") for pid in children.read_text().split()}
    os.kill(int(viewer), signal.SIGTERM)
    viewing.process.wait(timeout=PATIENCE_S)
    assert viewing.process.returncode == 0
    assert "messages sent to Rerun" in viewing.said()


@needs_rerun
def test_a_viewer_that_cannot_start_says_why(running: System, scene: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("", 0))  # on every address, as that of the viewer is not known
        taken.listen()
        refused = running.actum("view", "--web", "--port", str(taken.getsockname()[1]), str(scene))
    assert refused.returncode == 1
    assert "listens on port" in refused.stderr


def test_without_its_extra_a_viewer_says_which_it_needs(running: System, scene: Path, tmp_path: Path) -> None:
    without = "import sys; sys.modules['rerun'] = sys.modules['foxglove'] = None; sys.argv = ['actum', *sys.argv[1:]]; "
    program = without + "from actum_command.__main__ import main; main()"
    for command, extra in (("view", "view"), ("foxglove", "foxglove")):
        asked = started(["-c", program, command, str(scene)], running.environment, tmp_path / command)
        assert asked.process.wait(timeout=PATIENCE_S) == 1
        assert install_command(extra) in asked.said()
