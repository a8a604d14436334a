"""The paper's recogniser answers from its three layers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.skeletons import PARTS
from handmade import paper_model
from people import STANDING, lacking
from som_classifier.attention import UNSEEN
from som_classifier.paper_model import PaperModel
from som_classifier.streams import Frame
from som_classifier.supervised import SupervisedLayer
from som_classifier.trace import ordered_vector

LEFT_ARM = list(PARTS).index("left_arm")


def walk(*cells: int, part: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Cells that only one part walks through, and motion of that part alone."""
    walked = np.full((len(cells), 5), 4)
    walked[:, part] = cells
    motion = np.zeros((len(cells), 5))
    motion[1:, part] = 0.1
    return walked, motion


def test_the_nearest_way_is_recognised() -> None:
    model = paper_model()
    down, up = model.classify(*walk(0, 3, 6)), model.classify(*walk(6, 3, 0))
    assert (down.label, up.label) == ("pull", "push")
    assert model.way(*walk(0, 3, 6)).tolist() == [[0, 0], [1, 0], [2, 0]]


def test_confidence_is_the_winners_share_of_the_cosines_by_hand() -> None:
    """The other way is 2² + 2² = 8 away, so y = (1, e⁻²) and the cosines are those of y with the axes."""
    answer = paper_model().classify(*walk(0, 3, 6))
    norm = np.hypot(1.0, np.exp(-2.0))
    assert answer.activations == pytest.approx({"pull": 1.0 / norm, "push": np.exp(-2.0) / norm})
    assert answer.confidence == pytest.approx(1.0 / (1.0 + np.exp(-2.0)))


def test_a_negative_cosine_is_no_confidence() -> None:
    model = paper_model()
    against = PaperModel(model.layer1, model.layer2, SupervisedLayer(-np.eye(2)), model.description)
    assert against.classify(*walk(0, 3, 6)).confidence == 0.0


def test_the_part_that_moves_is_the_one_read() -> None:
    answer = paper_model().classify(*walk(6, 3, 0, part=LEFT_ARM))
    assert (answer.part, answer.label) == ("left_arm", "push")


def test_a_model_may_fix_the_part() -> None:
    model, walked = paper_model(part="right_leg"), walk(6, 3, 0, part=LEFT_ARM)
    assert model.classify(*walked).part == "right_leg"
    assert model.way(*walked).tolist() == [[1, 1]]


@given(st.lists(st.integers(0, 8), min_size=1, max_size=12), st.integers(2, 5))
def test_pace_does_not_matter(cells: list[int], dwell: int) -> None:
    model = paper_model()
    walked, slowly = (walk(*np.repeat(cells, times)) for times in (1, dwell))
    assert model.classify(*walked) == model.classify(*slowly)
    np.testing.assert_array_equal(model.way(*walked), model.way(*slowly))


def test_one_frame_is_answered_and_none_is_an_error() -> None:
    assert paper_model().way(*walk(3)).tolist() == [[1, 0]]
    assert paper_model().classify(*walk(3)).label in {"pull", "push"}
    with pytest.raises(ValueError, match="no frame"):
        paper_model().classify(*walk())


def test_cells_are_the_nearest_neuron_of_each_part() -> None:
    model = paper_model()
    joints = np.random.default_rng(1).random((15, 3))
    for cell, part in zip(model.cells(joints), PARTS.values(), strict=True):
        distances = np.linalg.norm(model.layer1.weights - joints[list(part)].ravel(), axis=1)
        assert cell == np.argmin(distances)


def test_a_part_without_a_joint_has_no_cell() -> None:
    cells = paper_model().cells(lacking(STANDING, "left_shoulder", "left_elbow", "left_hand"))
    assert (cells == UNSEEN).tolist() == [part == "left_arm" for part in PARTS]
    np.testing.assert_array_equal(np.delete(cells, LEFT_ARM), np.delete(paper_model().cells(STANDING), LEFT_ARM))


def test_frames_without_the_part_leave_no_trace_and_less_confidence() -> None:
    cells, motion = walk(0, 3, 3, 6)
    whole, way = paper_model().classify(cells, motion), paper_model().way(cells, motion)
    cells[2, 0] = UNSEEN
    partly = paper_model().classify(cells, motion)
    assert paper_model().way(cells, motion).tolist() == way.tolist()
    assert partly.activations == whole.activations
    assert partly.confidence == pytest.approx(0.75 * whole.confidence)


def test_frames_are_read_through_the_codes_of_the_encoder() -> None:
    model, rng = paper_model(), np.random.default_rng(0)
    poses, motion = [STANDING + rng.normal(0, 0.3, (15, 3)) for _ in range(6)], rng.random((6, 5))
    frames = [Frame(i, None, (), 0, 0.0, joints, motion[i]) for i, joints in enumerate(poses)]
    encoder = model.encoder()
    for frame in frames:
        frame.code = encoder.encode(frame)
    expected = model.classify(np.stack([model.cells(joints) for joints in poses]), motion)
    for complete in (False, True):
        answer = model.recognise(frames, complete)
        assert (answer.activations, answer.part) == (expected.activations, expected.part)
        assert (answer.familiarity, answer.unknown) == (None, False)
    with pytest.raises(ValueError, match="no frame"):
        model.recognise([], True)


def test_the_map_of_actions_is_most_active_where_the_way_is_nearest() -> None:
    model, (cells, motion) = paper_model(), walk(0, 3, 6)
    frames = [
        Frame(i, None, (), 0, 0.0, STANDING, moved, code=code)
        for i, (code, moved) in enumerate(zip(cells, motion, strict=True))
    ]
    (activities,) = model.maps(frames).values()
    nearest = model.layer2.bmu(ordered_vector(model.way(cells, motion), model.description.points))
    assert activities.shape == (model.layer2.rows, model.layer2.cols)
    assert activities.max() == activities.ravel()[nearest] == 1
