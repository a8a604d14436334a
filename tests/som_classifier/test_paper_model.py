"""The paper's recogniser answers from its three layers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.skeletons import PARTS
from handmade import paper_model
from people import STANDING, lacking
from som_classifier.frames import Frame
from som_classifier.kinematics import Kinematics
from som_classifier.map_activity import NO_WINNER, MapActivity, ordered_vector
from som_classifier.paper_model import PaperModel
from som_classifier.supervised import SupervisedLayer

LEFT_ARM = list(PARTS).index("left_arm")


def walk(*cells: int, part: int = 0) -> list[Frame]:
    """Frames in which only one part moves, and walks through cells of which nothing but the winner is active."""
    frames = []
    for number, cell in enumerate(cells):
        winners = np.full(5, 4)
        winners[part] = cell
        centres = np.where(winners[:, None] == NO_WINNER, np.nan, paper_model().layer1.coordinates[winners])
        motion = np.zeros(5)
        motion[part] = 0.1
        frames.append(Frame(number, None, (), 0, 0.0, STANDING, motion, activity=MapActivity(winners, centres)))
    return frames


def test_the_nearest_way_is_recognised() -> None:
    model = paper_model()
    down, up = model.recognise(walk(0, 3, 6), True), model.recognise(walk(6, 3, 0), True)
    assert (down.label, up.label) == ("pull", "push")
    assert model.trace(walk(0, 3, 6)).tolist() == [[0, 0], [1, 0], [2, 0]]


def test_confidence_is_the_winners_share_of_the_cosines_by_hand() -> None:
    """The other way is 2² + 2² = 8 away, so y = (1, e⁻²) and the cosines are those of y with the axes."""
    answer = paper_model().recognise(walk(0, 3, 6), True)
    norm = np.hypot(1.0, np.exp(-2.0))
    assert answer.activations == pytest.approx({"pull": 1.0 / norm, "push": np.exp(-2.0) / norm})
    assert answer.confidence == pytest.approx(1.0 / (1.0 + np.exp(-2.0)))


@pytest.mark.parametrize("off_deg", [5.0, 45.0, 80.0, 89.0])
def test_two_actions_that_are_equally_like_a_way_share_the_confidence_however_unlike_both_are(off_deg: float) -> None:
    model = paper_model()
    answered, off = np.arctan(np.exp(-2.0)), np.radians(off_deg)
    axes = np.array([[np.cos(answered + side), np.sin(answered + side)] for side in (off, -off)])
    answer = PaperModel(model.layer1, model.layer2, SupervisedLayer(axes), model.metadata).recognise(
        walk(0, 3, 6), True
    )
    assert list(answer.activations.values()) == pytest.approx([np.cos(off)] * 2)
    assert answer.confidence == pytest.approx(0.5)


def test_a_negative_cosine_is_no_confidence() -> None:
    model = paper_model()
    against = PaperModel(model.layer1, model.layer2, SupervisedLayer(-np.eye(2)), model.metadata)
    assert against.recognise(walk(0, 3, 6), True).confidence == 0.0


def test_the_part_that_moves_is_the_one_read() -> None:
    answer = paper_model().recognise(walk(6, 3, 0, part=LEFT_ARM), True)
    assert (answer.part, answer.label) == ("left_arm", "push")


def test_a_model_may_fix_the_part() -> None:
    model, walked = paper_model(attention="right_leg"), walk(6, 3, 0, part=LEFT_ARM)
    assert model.recognise(walked, True).part == "right_leg"
    assert model.trace(walked).tolist() == [[1, 1]]


@given(st.lists(st.integers(0, 8), min_size=1, max_size=12), st.integers(2, 5))
def test_pace_does_not_matter(cells: list[int], dwell: int) -> None:
    model = paper_model()
    walked, slowly = (walk(*np.repeat(cells, times).tolist()) for times in (1, dwell))
    assert model.recognise(walked, True) == model.recognise(slowly, True)
    np.testing.assert_array_equal(model.trace(walked), model.trace(slowly))


def test_one_frame_is_answered_and_none_is_an_error() -> None:
    assert paper_model().trace(walk(3)).tolist() == [[1, 0]]
    assert paper_model().recognise(walk(3), False).label in {"pull", "push"}
    with pytest.raises(ValueError, match="no frame"):
        paper_model().recognise([], True)


def test_a_look_is_the_nearest_unit_of_each_part() -> None:
    model = paper_model()
    joints = np.random.default_rng(1).random((15, 3))
    looked = joints - joints[[9, 12]].mean(axis=0)
    for winner, part in zip(model.first_activity(joints, STANDING).winners, PARTS.values(), strict=True):
        distances = np.linalg.norm(model.layer1.weights - looked[list(part)].ravel(), axis=1)
        assert winner == np.argmin(distances)


def test_a_part_without_a_joint_has_no_winner() -> None:
    seen = paper_model().first_activity(lacking(STANDING, "left_shoulder", "left_elbow", "left_hand"), STANDING)
    whole = paper_model().first_activity(STANDING, STANDING)
    assert (seen.winners == NO_WINNER).tolist() == [part == "left_arm" for part in PARTS]
    assert np.isnan(seen.centres).all(axis=1).tolist() == [part == "left_arm" for part in PARTS]
    np.testing.assert_array_equal(np.delete(seen.winners, LEFT_ARM), np.delete(whole.winners, LEFT_ARM))


def test_frames_without_the_part_leave_no_trace_and_less_confidence() -> None:
    model = paper_model()
    whole, partly = walk(0, 3, 3, 6), walk(0, 3, NO_WINNER, 6)
    assert model.trace(partly).tolist() == model.trace(whole).tolist()
    assert model.recognise(partly, True).activations == model.recognise(whole, True).activations
    assert model.recognise(partly, True).confidence == pytest.approx(0.75 * model.recognise(whole, True).confidence)


@pytest.mark.parametrize("axes", ["posture", "upright"])
def test_frames_are_read_through_the_codes_of_the_encoder(axes: str) -> None:
    """Along the axes that the model names, and of nothing else."""
    model, rng = (
        paper_model(axes=axes, origin="torso", attention="left_leg"),
        np.random.default_rng(0),
    )
    drawn = [STANDING + rng.normal(0, 0.3, (2, 15, 3)) for _ in range(6)]
    frames = [
        Frame(i, None, (), 0, 0.0, joints, np.zeros(5), Kinematics(upright, upright))
        for i, (joints, upright) in enumerate(drawn)
    ]
    encoder = model.encoder()
    for frame, (joints, upright) in zip(frames, drawn, strict=True):
        frame.activity = encoder.encode(frame)
        elsewhere = np.zeros((15, 3))
        given = (joints, elsewhere) if axes == "posture" else (elsewhere, upright)
        np.testing.assert_array_equal(frame.activity.centres, model.first_activity(*given).centres)
    for complete in (False, True):
        answer = model.recognise(frames, complete)
        assert (answer.part, answer.familiarity, answer.unknown) == ("left_leg", None, False)


def test_the_map_of_actions_is_most_active_where_the_way_is_nearest() -> None:
    model, frames = paper_model(), walk(0, 3, 6)
    (activities,) = model.maps(frames).values()
    nearest = model.layer2.bmu(ordered_vector(model.trace(frames), model.metadata.points))
    assert nearest == model.action_unit(frames)
    assert activities.shape == (model.layer2.rows, model.layer2.cols)
    assert activities.max() == activities.ravel()[nearest] == 1
