"""Contacts are found in recordings: when an object begins to move in a labelled action, and whose hand is near."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from actum.messages import Message, Objects, Segment, Skeleton, Truth
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_model_trainer.foreseeing.intent_report import summary
from actum_model_trainer.foreseeing.intent_scores import intent_scores
from actum_model_trainer.foreseeing.recorded import Recorded, recorded_in
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from reaching import FAR_M, messages, objects, true_contacts

Record = Callable[..., Recording]
LATEST_S = 0.15
"""How long after its first 5 mm an object has moved 2 cm."""


@pytest.fixture(scope="module")
def scene() -> list[Message]:
    return messages()


def without(kind: type[Message], scene: list[Message]) -> list[Message]:
    return [message for message in scene if not isinstance(message, kind)]


def assert_true(recorded: Recorded) -> None:
    """The contacts are the true ones, of the right objects and hands, and only the pointing has none."""
    [take] = recorded.takes
    true = list(true_contacts())
    assert [each[1:] for each in take.contacts] == [each[1:] for each in true]
    late_s = [(found.stamp_ns - each.stamp_ns) / SECOND_NS for found, each in zip(take.contacts, true, strict=True)]
    assert all(0 <= each <= LATEST_S for each in late_s), late_s
    assert recorded.without_contact == 1


def test_a_contact_is_the_first_motion_of_the_object_that_the_truth_names(record: Record, scene: list[Message]) -> None:
    assert_true(recorded_in([record("true", *scene)]))


def test_without_a_truth_it_is_the_object_that_moves_first_near_a_hand(record: Record, scene: list[Message]) -> None:
    assert_true(recorded_in([record("marks", *without(Truth, scene))]))


def test_an_object_that_moves_where_no_hand_is_near_is_not_touched(record: Record, scene: list[Message]) -> None:
    moving = [
        objects(each.stamp_ns + 1, {9: FAR_M + np.array([each.stamp_ns / SECOND_NS % 1.0, 0.0, 0.0])}, each.session_id)
        for each in scene
        if isinstance(each, Objects)
    ]
    recorded = recorded_in([record("beside", *without(Truth, scene), *moving)])
    assert 9 in recorded.takes[0].objects_m
    assert_true(recorded)


def test_recorded_postures_count_where_there_are_no_skeletons(record: Record, scene: list[Message]) -> None:
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    skeletons = (message for message in scene if isinstance(message, Skeleton))
    postures = [posture for skeleton in skeletons for posture in preprocessor.handle(skeleton)]
    assert_true(recorded_in([record("postures", *without(Skeleton, scene), *postures)]))


def test_while_somebody_points_at_an_object_no_contact_is_announced_in_vain(
    record: Record, scene: list[Message]
) -> None:
    [take] = recorded_in([record("pointing", *scene)]).takes
    [(start_ns, end_ns)] = take.pointing_ns
    starts = [each.stamp_ns for each in scene if isinstance(each, Segment) and each.kind == "start"]
    assert starts[2] == start_ns < end_ns < starts[3]


def test_actions_that_are_not_labelled_have_no_contacts(record: Record, scene: list[Message]) -> None:
    recorded = recorded_in([record("unmarked", *without(Segment, scene))])
    assert (recorded.contacts, recorded.without_contact) == (0, 0)
    assert len(recorded.takes) == 1


def test_without_objects_nothing_can_be_foreseen(record: Record, scene: list[Message]) -> None:
    recorded = recorded_in([record("nothing", *without(Objects, scene))])
    assert (recorded.takes, recorded.without_contact) == ([], 4)


def test_an_object_is_placed_in_the_first_frame_after_it_was_seen(record: Record, scene: list[Message]) -> None:
    rare = [each for each in scene if isinstance(each, Objects)][::3]
    [take] = recorded_in([record("rare", *without(Objects, scene), *rare)]).takes
    seen = np.flatnonzero(np.isfinite(take.objects_m[1][:, 0]))
    assert {later - earlier for earlier, later in pairwise(seen.tolist())} == {3}
    stamps_ns = {each.stamp_ns for each in rare}
    assert {int(take.stamps_ns[row]) for row in seen} <= stamps_ns


def test_the_scores_tell_of_contacts_minutes_and_each_method(record: Record, scene: list[Message]) -> None:
    recorded = recorded_in([record("scored", *scene)])
    scores = intent_scores(recorded)
    assert (scores.contacts, scores.without_contact) == (3, 1)
    assert scores.minutes == pytest.approx(recorded.takes[0].minutes)
    assert list(scores.methods) == ["actum", "nearest object", "constant velocity", "minimum jerk", "never"]
    assert scores.methods["actum"].ahead.median_s > 0.2
    assert scores.methods["never"].ahead.recall == 0.0
    assert scores.as_json()["methods"]["never"]["brier"] is None
    assert scores.as_json()["methods"]["actum"]["right"]["0.5"] == scores.methods["actum"].at_half.right
    assert summary(scores, 1.0)[0] == (
        f"3 contacts in {scores.minutes:.1f} min, labelled actions without a contact: 1, 1.0 s"
    )
