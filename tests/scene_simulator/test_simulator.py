from itertools import islice

import cv2
import numpy as np
import pytest

from actum.messages import Image, Message, Segment, Skeleton, Truth
from scene_simulator.programme import Task
from scene_simulator.simulator import Simulator, labelled_stream

PROGRAMME = [Task("lift", 2), Task("point", 1)]


def all_of(simulator: Simulator) -> list[Message]:
    return [message for messages in simulator.frames() for message in messages]


@pytest.fixture(scope="module")
def frames() -> list[list[Message]]:
    return list(Simulator(PROGRAMME, 2, 5, start_ns=10**15, image_hz=15).frames())


@pytest.mark.thorough
def test_the_same_arguments_give_the_same_messages_again_and_again(frames: list[list[Message]]) -> None:
    simulator = Simulator(PROGRAMME, 2, 5, start_ns=10**15, image_hz=15)
    list(islice(simulator.frames(), 20))

    assert list(simulator.frames()) == frames


def test_images_do_not_change_the_skeletons(frames: list[list[Message]]) -> None:
    alone = all_of(Simulator(PROGRAMME, 2, 5, start_ns=10**15, image_hz=0))

    assert alone == [m for messages in frames for m in messages if not isinstance(m, Image)]


def test_every_frame_has_one_skeleton_and_every_second_an_image_of_the_same_instant(frames) -> None:
    for number, messages in enumerate(frames):
        assert {m.stamp_ns for m in messages} == {10**15 + round(number * 1e9 / 30)}
        assert sum(isinstance(m, Skeleton) for m in messages) == 1
        assert sum(isinstance(m, Image) for m in messages) == (number % 2 == 0)
        assert {m.session_id for m in messages if not isinstance(m, Truth)} == {"simulator-2-5"}


def test_stamps_do_not_drift() -> None:
    simulator = Simulator(PROGRAMME)

    assert [simulator.stamp_ns(k) for k in (0, 1, 2, 3)] == [0, 33_333_333, 66_666_667, 100_000_000]
    assert simulator.stamp_ns(30 * 3600) == 3600 * 10**9


def test_the_truth_says_what_was_done_to_which_object_and_how_it_moved(frames: list[list[Message]]) -> None:
    truths = [m for messages in frames for m in messages if isinstance(m, Truth)]

    assert [(t.kind, t.action, t.object_id) for t in truths] == [
        ("start", "lift", 2),
        ("end", "lift", 2),
        ("start", "point", 1),
        ("end", "point", 1),
    ]
    lifted, pointed_at = truths[1].displacement_m, truths[3].displacement_m
    assert lifted is not None
    assert -0.23 < lifted[1] < -0.09
    assert pointed_at == [0, 0, 0]
    assert truths[0].displacement_m is None
    assert (truths[1].object_name, truths[3].object_name) == ("box", "cup")
    assert truths[0].segment_id == truths[1].segment_id != truths[2].segment_id
    assert all(
        1.4e9 < end.stamp_ns - start.stamp_ns < 2.6e9 for start, end in zip(truths[::2], truths[1::2], strict=True)
    )


def test_a_segments_name_does_not_tell_the_action() -> None:
    names = [
        {t.segment_id for t in all_of(Simulator([Task(a, 1)], image_hz=0)) if isinstance(t, Truth)}
        for a in ("put", "pull")
    ]

    assert names[0] == names[1] == {"s0-0-000"}


def test_images_are_jpegs_of_an_ideal_camera(frames: list[list[Message]]) -> None:
    image = next(m for m in frames[0] if isinstance(m, Image))
    decoded = cv2.imdecode(np.frombuffer(image.data, dtype=np.uint8), cv2.IMREAD_COLOR)

    assert (image.format, image.width, image.height) == ("jpeg", 640, 480)
    assert decoded is not None
    assert decoded.shape == (480, 640, 3)
    assert image.K == [525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0]
    assert not any(image.distortion)
    assert image.skeleton_from_image == np.eye(4).ravel().tolist()


def test_skeletons_are_the_true_joints_seen_with_noise(frames: list[list[Message]]) -> None:
    simulator = Simulator(PROGRAMME, 2, 5, image_hz=0)
    seen = [m.agents[0].joints for messages in frames for m in messages if isinstance(m, Skeleton)]
    true = [state.joints_m for state in simulator.scene.states()]
    missed = np.array(seen) - np.array(true)

    assert 0.005 < missed[:, 2].std() < 0.015
    assert 0.010 < missed[:, 8].std() < 0.040
    assert np.abs(missed.mean(axis=0)).max() < 0.02


def test_a_labelled_stream_marks_each_action() -> None:
    marks = [m for m in labelled_stream(Simulator(PROGRAMME, image_hz=0)) if isinstance(m, Segment)]

    assert [(m.kind, m.label, m.agent) for m in marks] == [
        ("start", "lift", 1),
        ("end", "lift", 1),
        ("start", "point", 1),
        ("end", "point", 1),
    ]
    assert [m.segment_id for m in marks] == ["s0-0-000"] * 2 + ["s0-0-001"] * 2


@pytest.mark.parametrize("image_hz", [-15, 7, 60])
def test_an_image_rate_that_does_not_divide_the_frame_rate_is_refused(image_hz: int) -> None:
    with pytest.raises(ValueError, match="does not divide"):
        Simulator(PROGRAMME, image_hz=image_hz)
