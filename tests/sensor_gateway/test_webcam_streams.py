"""A network camera, for real: its stream is read, ends, is told to be lost, and is found again."""

import socket
import threading
from collections.abc import Iterator
from contextlib import nullcontext
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import cv2
import numpy as np
import pytest

from actum.messages import Image, Skeleton
from live import wait_until
from sensor_gateway.camera_source import CameraSource
from sensor_gateway.devices import silence, webcam
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.webcam import LiveCapture
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Landmarks

PICTURES = 12
BETWEEN_S = 0.02


class Blind:
    """A model that sees nobody."""

    def people(self, image_bgr: np.ndarray, stamp_ns: int) -> list[Landmarks]:
        return []


@pytest.fixture
def camera() -> Iterator[str]:
    """A camera that gives a few pictures to each who asks, from the middle on at half the resolution, and hangs up."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=picture")
            self.end_headers()
            rng = np.random.default_rng(0)
            for number in range(PICTURES):
                size = (48, 64, 3) if number < PICTURES / 2 else (24, 32, 3)
                data = cv2.imencode(".jpg", rng.integers(0, 255, size).astype(np.uint8))[1].tobytes()
                head = f"--picture\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
                self.wfile.write(head.encode() + data + b"\r\n")
                stopped.wait(BETWEEN_S)

        def log_message(self, *_: object) -> None:
            pass

    stopped = threading.Event()
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/camera.mjpg"
    stopped.set()
    server.shutdown()
    thread.join()
    server.server_close()


def test_a_stream_that_ends_is_lost_and_comes_back_by_itself(camera: str) -> None:
    source = CameraSource(
        lambda: nullcontext(Blind()), Optics(), lambda: LiveCapture(camera), sensor="kinect0", session_id="s"
    )
    frames = source.frames()
    told: list[Skeleton] = []
    sizes: set[tuple[int, int]] = set()
    while [skeleton.valid for skeleton in told].count(False) == 0 or not told[-1].valid:
        for message in next(frames):
            if isinstance(message, Skeleton):
                told.append(message)
            elif isinstance(message, Image):
                sizes.add((message.width, message.height))
    frames.close()  # type: ignore[attr-defined]
    assert sizes == {(64, 48)}, "OpenCV scales all pictures to the size of the first"
    assert told[0].valid
    assert {skeleton.reason for skeleton in told} == {None, "camera lost: it gives no more pictures"}
    assert source.counters.state == "running"
    stamps = [skeleton.stamp_ns for skeleton in told]
    assert stamps == sorted(set(stamps))


@pytest.fixture
def mute() -> Iterator[str]:
    """A camera that takes calls and never answers."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"http://127.0.0.1:{server.getsockname()[1]}/camera.mjpg"


def test_a_stream_that_never_answers_is_let_go_of_when_it_counts_as_lost(
    mute: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (silence, webcam):
        monkeypatch.setattr(module, "OPENING_S", 0.3)
    silent = LiveCapture(mute)
    wait_until(lambda: silent.over, "the attempt has ended")
    with pytest.raises(CameraLostError):
        silent.next(0.0)
