"""Views from a live stream: what is said where no image comes that can be used."""

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import cv2
import pytest
from typer.testing import CliRunner

from actum.messages import Image, Message
from actum_calibrator.board import Board
from actum_calibrator.board_views import BoardFinder, View
from actum_command import live_calibration
from actum_command.__main__ import app
from actum_command.commands import calibrate_commands
from boards import Lens, good_poses, photograph
from empty_messages import image, skeleton

MISMATCH = "image_size_mismatch: 1280x720, calibrated for 640x480"
INVALID = image(0).model_copy(update={"valid": False, "reason": MISMATCH})
Said = Callable[[Iterable[Message]], str]


def streaming(monkeypatch: pytest.MonkeyPatch, messages: Iterable[Message]) -> threading.Event:
    """Have these messages come from the sensor, each a second after the last, and then none."""
    coming, clock_s, stop = iter(messages), iter(range(1000)), threading.Event()

    def receive() -> SimpleNamespace | None:
        message = next(coming, None)
        return None if message is None else SimpleNamespace(message=message)

    client = SimpleNamespace(sensor="kinect0", listen=lambda key, ring: SimpleNamespace(receive=receive))
    monkeypatch.setattr(calibrate_commands, "connect", lambda: nullcontext(client))
    monkeypatch.setattr(calibrate_commands, "stop_on_signals", lambda: stop)
    monkeypatch.setattr(live_calibration, "POLL_S", 0)
    monkeypatch.setattr(live_calibration, "time", SimpleNamespace(monotonic=lambda: next(clock_s)))
    return stop


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Said:
    """Return what the command says that calibrates from the messages that come."""

    def run(messages: Iterable[Message]) -> str:
        streaming(monkeypatch, messages)
        done = CliRunner().invoke(app, ["calibrate", "intrinsics", "--live", "-o", str(tmp_path / "c.yaml")])
        assert done.exit_code == 1, done.output
        return " ".join(done.stderr.split())

    return run


def test_where_no_image_comes_the_gateway_is_asked_for_and_its_calibration_named(said: Said) -> None:
    for messages in ([], [skeleton(1), skeleton(2)]):
        told = said(messages)
        assert "no image arrived on actum/kinect0/image/color for 10 s: check that the sensor gateway" in told
        assert "ACTUM_CALIBRATION" in told


def test_where_images_come_that_are_not_valid_their_reason_is_said_and_the_calibration_named(said: Said) -> None:
    told = said([INVALID] * 20)
    assert f"no valid image arrived on actum/kinect0/image/color for 10 s ({MISMATCH})." in told
    assert "ACTUM_CALIBRATION" in told
    assert "does its gateway send any" not in told


def test_an_invalid_image_between_valid_ones_is_no_cause(said: Said) -> None:
    assert "no image arrived on" in said([image(1), INVALID, image(2)])


def test_views_are_taken_of_the_valid_images_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    board = Board()
    picture = cv2.imencode(".jpg", photograph(Lens(), board, good_poses(board)[0]))[1].tobytes()
    seen = image(1).model_copy(update={"width": 640, "height": 480, "data": picture})

    def messages() -> Iterator[Image]:
        yield from (INVALID, seen, INVALID, seen)
        stop.set()

    stop = streaming(monkeypatch, messages())
    with calibrate_commands.connect() as client:
        [view] = live_calibration.collect_views(client, BoardFinder(board), stop, print)
    assert isinstance(view, View)
    assert view.size == (640, 480)
