"""The person who takes requests stands without a break, and does one thing after the other."""

from itertools import islice

import numpy as np
import pytest

from actum.commands import Refusal
from actum.messages import Skeleton, Truth
from scene_simulator.driven_simulator import DrivenSimulator
from scene_simulator.settings import Settings

SECONDS = 30
"""Frames of a second."""


def simulator() -> DrivenSimulator:
    return DrivenSimulator(Settings(image_hz=0), start_ns=10**9)


def ask(person: DrivenSimulator, **fields: object) -> None:
    person.commands[0].obey(fields)


def test_the_person_stands_still_and_sways_but_never_jumps() -> None:
    frames = [message for messages in islice(simulator().frames(), 10 * SECONDS) for message in messages]
    joints = np.array([frame.agents[0].joints for frame in frames if isinstance(frame, Skeleton)])
    torso = joints[:, 2]
    assert np.linalg.norm(np.diff(torso, axis=0), axis=1).max() < 0.04
    assert np.ptp(torso, axis=0).max() > 0.01
    stamps = [frame.stamp_ns for frame in frames]
    assert len(set(stamps)) == len(stamps) == 10 * SECONDS and stamps == sorted(stamps)


def test_what_is_asked_for_is_done_in_order_with_pauses() -> None:
    person = simulator()
    frames = person.frames()
    before = list(islice(frames, SECONDS))
    ask(person, actions=["lift", "push"], object_id=1, pause_s=2.0)
    ask(person, actions=["lift"], object_id=1)
    after = [message for messages in islice(frames, 20 * SECONDS) for message in messages]
    truths = [message for message in after if isinstance(message, Truth)]
    assert not [message for messages in before for message in messages if isinstance(message, Truth)]
    assert [(truth.kind, truth.action) for truth in truths] == [
        (kind, action) for action in ("lift", "push", "lift") for kind in ("start", "end")
    ]
    assert len({truth.segment_id for truth in truths}) == 3
    assert truths[2].stamp_ns - truths[1].stamp_ns >= 2 * 10**9
    assert isinstance(after[-1], Skeleton) and after[-1].stamp_ns > truths[-1].stamp_ns + 2 * 10**9


def test_what_cannot_be_done_is_refused() -> None:
    for fields in (
        {},
        {"actions": ["fly"]},
        {"actions": ["lift"], "object_id": 99},
        {"actions": ["lift"], "pause_s": -1},
    ):
        with pytest.raises(Refusal):
            ask(simulator(), **fields)
