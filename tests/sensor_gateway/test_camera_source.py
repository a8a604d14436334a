"""The camera as a source: what each picture becomes, and what happens while there is none."""

import math
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import cv2
import numpy as np
import pytest

from actum.calibration import Calibration, CalibrationError
from actum.messages import Image, Message, Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from camera_bodies import K, as_seen, standing_at
from sensor_gateway.camera_source import CameraSource
from sensor_gateway.cameras import optics_of
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError, CaptureEndedError
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.settings import Settings

FRAME_NS = SECOND_NS // 20
CALIBRATION = Calibration(image_size=(640, 480), K=K.ravel().tolist(), distortion=[0.0] * 5)
Step = str | int | None
"""A picture with a person at so many decimetres to the right, "lost", "over", "frozen", "black", or none yet."""


class World:
    """A clock, cameras that do as they are told one after another, and a model that sees who is there."""

    def __init__(self, *cameras: Sequence[Step], live: bool = True) -> None:
        self.now_ns = 10 * SECOND_NS
        self.opened: list[int] = []
        self.closed = 0
        self.live, self.rate_hz = live, None
        self.model_closed = False
        self._cameras = [iter(steps) for steps in cameras]
        self._rng = np.random.default_rng(0)
        self._who: list[Landmarks] = []
        self._still = self._noise()

    def source(self, optics: Optics | None = None) -> CameraSource:
        return CameraSource(
            self._model,
            optics or Optics(),
            self._open,
            sensor="kinect0",
            session_id="s",
            now_ns=lambda: self.now_ns,
            pause=self._pass,
        )

    def people(self, image_bgr: np.ndarray, stamp_ns: int) -> list[Landmarks]:
        return self._who

    def next(self, patience_s: float) -> Picture | None:
        self._pass(FRAME_NS / SECOND_NS)
        match next(self._steps, "over"):
            case None:
                return None
            case "lost":
                raise CameraLostError("unplugged")
            case "over":
                raise CaptureEndedError("clip.mp4")
            case "frozen":
                image = self._still
            case "black":
                image = np.zeros((480, 640, 3), np.uint8)
            case int(decimetres):
                self._who = [as_seen(standing_at(decimetres / 10, 2.5))]
                image = self._noise()
        return Picture(image, self.now_ns)

    def close(self) -> None:
        self.closed += 1

    def _open(self) -> "World":
        self.opened.append(self.now_ns)
        self._steps = self._cameras.pop(0) if self._cameras else iter(["over"])
        return self

    def _model(self) -> AbstractContextManager["World"]:
        world = self

        class Model(nullcontext["World"]):
            def __exit__(self, *_: object) -> None:
                world.model_closed = True

        return Model(self)

    def _noise(self) -> np.ndarray:
        return self._rng.integers(100, 120, (480, 640, 3)).astype(np.uint8)

    def _pass(self, seconds: float) -> None:
        self.now_ns += round(seconds * SECOND_NS)


def messages(world: World, optics: Optics | None = None) -> list[Message]:
    return [message for listed in world.source(optics).frames() for message in listed]


def skeletons(found: Sequence[Message]) -> list[Skeleton]:
    return [message for message in found if isinstance(message, Skeleton)]


def test_each_picture_is_an_image_and_then_the_skeletons_in_it_with_the_captures_stamp() -> None:
    found = messages(World([0, 0]))
    assert [type(message) for message in found] == [Image, Skeleton, Image, Skeleton]
    assert [message.stamp_ns for message in found] == [10 * SECOND_NS + n * FRAME_NS for n in (1, 1, 2, 2)]
    [first, *_] = skeletons(found)
    assert [agent.agent for agent in first.agents] == [1]
    assert first.agents[0].joints[INDEX["right_hand"]] is not None
    assert first.agents[0].depth_std_m == pytest.approx(0.07 * 2.65, rel=0.05)


def test_the_image_can_be_decoded_and_says_that_its_intrinsics_are_assumed() -> None:
    [image, *_] = messages(World([0]), Optics(field_of_view_deg=90.0))
    assert isinstance(image, Image)
    pixels = cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR)
    assert pixels.shape == (480, 640, 3)
    assert (image.format, image.width, image.height, image.intrinsics_assumed) == ("jpeg", 640, 480, True)
    assert [image.K[0], image.K[2], image.K[5]] == pytest.approx([320.0, 319.5, 239.5])


def test_a_calibration_is_used_for_image_and_joints_alike() -> None:
    image, skeleton = messages(World([3]), Optics(calibration=CALIBRATION))
    assert isinstance(image, Image)
    assert isinstance(skeleton, Skeleton)
    assert (image.K, image.intrinsics_assumed) == (K.ravel().tolist(), False)
    torso = skeleton.agents[0].joints[INDEX["torso"]]
    assert torso is not None
    assert torso[0] == pytest.approx(0.3, abs=0.05)
    assert torso[2] == pytest.approx(2.5, abs=0.05)


def test_images_of_another_size_than_was_calibrated_show_nothing() -> None:
    source = World([0]).source(Optics(calibration=CALIBRATION.model_copy(update={"image_size": (1280, 720)})))
    [skeleton] = [message for listed in source.frames() for message in listed]
    assert (skeleton.valid, skeleton.reason) == (False, "image_size_mismatch: 640x480, calibrated for 1280x720")
    assert source.counters.rejects == {"image_size_mismatch": 1}


def test_a_calibration_of_a_camera_beside_this_one_is_refused(tmp_path: Path) -> None:
    beside = np.eye(4)
    beside[0, 3] = 0.12
    for name, transform in (("own", None), ("same", np.eye(4)), ("beside", beside)):
        listed = None if transform is None else transform.ravel().tolist()
        CALIBRATION.model_copy(update={"skeleton_from_image": listed}).save(tmp_path / name)
        settings = Settings(source="camera", calibration=tmp_path / name)
        if name == "beside":
            with pytest.raises(CalibrationError, match="so it is the calibration of a marker camera: start that"):
                optics_of(settings)
        else:
            assert optics_of(settings).calibration == Calibration.load(tmp_path / name)


def test_info_tells_how_well_the_camera_is_known() -> None:
    assert "assumed: 60 degrees" in World().source().counters.details["calibration"]
    assert World().source(Optics(calibration=CALIBRATION)).counters.details["calibration"] == CALIBRATION.id


def test_a_lost_camera_is_told_at_once_and_tried_again_ever_later_until_it_is_back() -> None:
    world = World([0, "lost"], ["lost"], ["lost"], [0, 0])
    source = world.source()
    states: list[tuple[bool, str]] = []
    for listed in source.frames():
        states += [(message.valid, source.counters.state) for message in listed if isinstance(message, Skeleton)]
    assert states[0] == (True, "running")
    assert states[1] == (False, "camera lost: unplugged")
    assert states[-1] == (True, "running")
    assert source.counters.rejects == {"camera_lost": 1}
    assert source.counters.last_error == "camera_lost: unplugged"
    waits_s = np.diff(world.opened[:4]) / SECOND_NS
    assert waits_s.tolist() == pytest.approx([0.5 + 0.1, 1 + 0.05, 2 + 0.05])


def test_while_it_is_lost_that_is_said_again_every_second() -> None:
    found = skeletons(messages(World(["lost"], ["lost"], ["lost"], ["lost"], [0])))
    told = [message for message in found if not message.valid]
    assert {message.reason for message in told} == {"camera lost: unplugged"}
    assert all(0.9 * SECOND_NS < gap < 1.3 * SECOND_NS for gap in np.diff([message.stamp_ns for message in told]))
    assert len(told) >= 6
    assert all(message.agents == [] for message in told)


def test_a_frozen_camera_is_lost_and_opened_again() -> None:
    world = World([0, *["frozen"] * 30], ["frozen"], [0, 0])
    found = skeletons(messages(world))
    assert next(message.reason for message in found if not message.valid) == (
        "camera lost: frozen: the picture has not changed for 1 s"
    )
    assert world.closed == len(world.opened) == 3
    assert found[-1].valid


def test_a_covered_lens_is_told_without_opening_anew_and_is_over_when_it_is_uncovered() -> None:
    world = World([0, *["black"] * 15, 0])
    found = skeletons(messages(world))
    blind = [message for message in found if not message.valid]
    assert blind[0].reason is not None
    assert blind[0].reason.startswith("camera lost: black")
    assert found[-1].valid
    assert len(world.opened) == 1


def test_a_camera_that_stays_black_is_opened_again_until_it_is_not_and_told_once_all_the_while() -> None:
    black = ["black"] * 200
    world = World([0, *black], black, black, [*["black"] * 20, 0, 0])
    source = world.source()
    found = skeletons([message for listed in source.frames() for message in listed])
    valid = [message.valid for message in found]
    first, last = valid.index(False), len(valid) - valid[::-1].index(False)
    assert not any(valid[first:last]), "it does not come and go"
    assert valid[last:] == [True, True]
    assert {message.reason for message in found[first:last]} == {
        "camera lost: black: nothing can be seen; is the lens covered?"
    }
    assert source.counters.rejects == {"camera_lost": 1}
    assert source.counters.state == "running"
    assert world.closed == len(world.opened) == 4
    assert (np.diff(world.opened) / SECOND_NS).tolist() == pytest.approx([5.55, 6.05, 7.05], abs=0.15)


def test_a_file_may_stand_still_and_be_black_and_its_end_is_the_sources() -> None:
    world = World([*["frozen"] * 30, *["black"] * 30, "over"], live=False)
    found = skeletons(messages(world))
    assert len(found) == 60
    assert all(message.valid for message in found)
    assert (world.closed, world.model_closed) == (1, True)


def test_waiting_for_a_picture_yields_nothing_so_that_the_source_can_be_stopped() -> None:
    frames: Iterator[list[Message]] = World([None, None, 0]).source().frames()
    assert [next(frames), next(frames)] == [[], []]


def test_stamps_rise_though_the_clock_is_set_back() -> None:
    world = World([0, 0, 0, 0])
    stamps = []
    for listed in world.source().frames():
        for message in skeletons(listed):
            stamps.append(message.stamp_ns)
            if len(stamps) == 2:
                world.now_ns -= 3600 * SECOND_NS
    assert np.diff(stamps)[1] > 0
    assert np.diff(stamps)[[0, 2]].tolist() == [FRAME_NS, FRAME_NS], "durations after that are right again"


def test_leaving_early_closes_camera_and_model() -> None:
    world = World([0, 0, 0])
    frames = world.source().frames()
    next(frames)
    frames.close()  # type: ignore[attr-defined]
    assert (world.closed, world.model_closed) == (1, True)


def test_a_rate_that_is_no_number_is_not_told() -> None:
    for rate_hz, told in ((30.0, "30"), (math.nan, None), (math.inf, None)):
        world = World([0])
        world.rate_hz = rate_hz
        source = world.source()
        assert list(source.frames())
        assert source.counters.details.get("rate_hz") == told
