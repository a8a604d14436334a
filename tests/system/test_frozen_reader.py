"""A reader that is stopped does not stall the others for longer than streams may lag."""

import signal
import threading
import time
from pathlib import Path

import pytest

from actum import keys
from actum.limits import MAX_SKEW_NS
from actum.messages import Image, Segment
from actum.runtime import Client
from live import System, wait_until

READER = """
import os
from actum.runtime import Client
from actum.settings import ServiceSettings
from pathlib import Path

with Client(ServiceSettings(), wait_s=30.0) as client:
    listening = client.listen_back("actum/**", 1.0)
    for _ in listening:
        Path(os.environ["ACTUM_HEALTH_FILE"]).touch()
"""
PICTURE = bytes(1280 * 720 * 3)
FROZEN_S = 6.0
pytestmark = pytest.mark.system


def picture(stamp_ns: int) -> Image:
    matrix = [500.0, 0.0, 640.0, 0.0, 500.0, 360.0, 0.0, 0.0, 1.0]
    return Image(
        stamp_ns=stamp_ns, sensor="kinect0", format="bgr8", width=1280, height=720, data=PICTURE, K=matrix,
        distortion=[], skeleton_from_image=[float(i % 5 == 0) for i in range(16)],
    )  # fmt: skip


def longest_way_s(writer: Client, reader: Client) -> float:
    """Put marks and pictures for some seconds; return how long a mark took at the most until the reader had it (s)."""
    marks = reader.listen(keys.key(keys.SEGMENT, reader.sensor))
    longest_s, began_s, put = 0.0, time.monotonic(), 0
    while time.monotonic() < began_s + FROZEN_S:
        writer.put(picture(put))
        put_s, put = time.monotonic(), put + 1
        writer.put(Segment(sensor="kinect0", kind="start", segment_id=str(put), stamp_ns=put))
        wait_until(lambda: marks.receive() is not None, "the mark has come")
        longest_s = max(longest_s, time.monotonic() - put_s)
        threading.Event().wait(1 / 15)
    return longest_s


def test_others_hear_within_the_time_that_streams_may_lag(
    running: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    heard, script = tmp_path / "heard", tmp_path / "reader.py"
    script.write_text(READER)
    monkeypatch.setenv("ACTUM_HEALTH_FILE", str(heard))
    running.start_router()
    frozen = running.start_script(script)
    with running.client() as writer, running.client() as reader:
        while not heard.exists():
            writer.put(Segment(sensor="kinect0", kind="start", segment_id="first", stamp_ns=0))
            threading.Event().wait(0.1)
        frozen.process.send_signal(signal.SIGSTOP)
        longest_s = longest_way_s(writer, reader)
        frozen.process.send_signal(signal.SIGCONT)
        frozen.process.kill()
    assert longest_s < MAX_SKEW_NS / 1e9
