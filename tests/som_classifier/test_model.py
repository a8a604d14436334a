"""A model answers from its three layers, and its file is sound or refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum.skeletons import PARTS
from actum.som import Som
from som_classifier.model import Description, Model, ModelError
from som_classifier.supervised import SupervisedLayer

POINTS = 3
LEFT_ARM = list(PARTS).index("left_arm")


def description(**changes: object) -> Description:
    fields: dict[str, object] = {
        "labels": ["pull", "push"],
        "points": POINTS,
        "contrast": 4.0,
        "part": None,
        "preset": "paper",
        "parameters": {"layer1": {"rows": 3, "radius": (1.5, 0.7)}},
        "seed": 7,
        "persons": ["1", "3"],
        "samples": 60,
        "data_digest": "abc",
        "actum_version": "0.1.0",
    }
    return Description.model_validate(fields | changes)


def two_way_model(**changes: object) -> Model:
    """A 3×3 map; the second map knows the way down its first column and the way up, each with its own neuron."""
    layer1 = Som.random(3, 3, 9, np.random.default_rng(0))
    down, up = [0.0, 0.0, 1.0, 0.0, 2.0, 0.0], [2.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    return Model(layer1, Som(1, 2, np.array([down, up])), SupervisedLayer(np.eye(2)), description(**changes))


def walk(*cells: int, part: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Cells that only one part walks through, and motion of that part alone."""
    walked = np.full((len(cells), 5), 4)
    walked[:, part] = cells
    motion = np.zeros((len(cells), 5))
    motion[1:, part] = 0.1
    return walked, motion


@pytest.fixture
def path(tmp_path: Path) -> Path:
    two_way_model().save(tmp_path / "model.npz")
    return tmp_path / "model.npz"


def test_the_nearest_way_is_recognised() -> None:
    model = two_way_model()
    down, up = model.recognise(*walk(0, 3, 6)), model.recognise(*walk(6, 3, 0))
    assert (down.label, up.label) == ("pull", "push")
    assert down.trace.tolist() == [[0, 0], [1, 0], [2, 0]]


def test_confidence_is_the_winners_share_of_the_cosines_by_hand() -> None:
    """The other way is 2² + 2² = 8 away, so y = (1, e⁻²) and the cosines are those of y with the axes."""
    answer = two_way_model().recognise(*walk(0, 3, 6))
    norm = np.hypot(1.0, np.exp(-2.0))
    assert answer.activations == pytest.approx({"pull": 1.0 / norm, "push": np.exp(-2.0) / norm})
    assert answer.confidence == pytest.approx(1.0 / (1.0 + np.exp(-2.0)))


def test_a_negative_cosine_is_no_confidence() -> None:
    model = two_way_model()
    against = Model(model.layer1, model.layer2, SupervisedLayer(-np.eye(2)), model.description)
    assert against.recognise(*walk(0, 3, 6)).confidence == 0.0


def test_the_part_that_moves_is_the_one_read() -> None:
    answer = two_way_model().recognise(*walk(6, 3, 0, part=LEFT_ARM))
    assert (answer.part, answer.label) == ("left_arm", "push")


def test_a_model_may_fix_the_part() -> None:
    answer = two_way_model(part="right_leg").recognise(*walk(6, 3, 0, part=LEFT_ARM))
    assert answer.part == "right_leg"
    assert answer.trace.tolist() == [[1, 1]]


@given(st.lists(st.integers(0, 8), min_size=1, max_size=12), st.integers(2, 5))
def test_pace_does_not_matter(cells: list[int], dwell: int) -> None:
    model = two_way_model()
    answer, slower = (model.recognise(*walk(*np.repeat(cells, times))) for times in (1, dwell))
    assert (answer.label, answer.activations) == (slower.label, slower.activations)
    np.testing.assert_array_equal(answer.trace, slower.trace)


def test_one_frame_is_answered_and_none_is_an_error() -> None:
    assert two_way_model().recognise(*walk(3)).trace.tolist() == [[1, 0]]
    with pytest.raises(ValueError, match="no frame"):
        two_way_model().recognise(*walk())


def test_cells_are_the_nearest_neuron_of_each_part() -> None:
    model = two_way_model()
    joints = np.random.default_rng(1).random((15, 3))
    for cell, part in zip(model.cells(joints), PARTS.values(), strict=True):
        distances = np.linalg.norm(model.layer1.weights - joints[list(part)].ravel(), axis=1)
        assert cell == np.argmin(distances)


def test_a_file_brings_back_the_same_model(path: Path) -> None:
    model, loaded = two_way_model(), Model.load(path)
    assert loaded.id == model.id
    assert loaded.labels == ["pull", "push"]
    assert loaded.metadata["persons"] == ["1", "3"]
    assert loaded.recognise(*walk(0, 4, 7)).activations == model.recognise(*walk(0, 4, 7)).activations


def test_the_id_changes_with_weights_and_with_metadata() -> None:
    model = two_way_model()
    moved = Model(Som(3, 3, model.layer1.weights + 1e-12), model.layer2, model.layer3, model.description)
    assert len({model.id, moved.id, two_way_model(seed=8).id}) == 3


def test_saving_leaves_nothing_but_the_file(path: Path) -> None:
    two_way_model(seed=8).save(path)
    assert list(path.parent.iterdir()) == [path]
    assert Model.load(path).metadata["seed"] == 8


def test_a_save_that_fails_leaves_the_old_file(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError("No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space"):
        two_way_model(seed=8).save(path)
    assert list(path.parent.iterdir()) == [path]
    assert Model.load(path).metadata["seed"] == 7


def refused(path: Path) -> str:
    with pytest.raises(ModelError) as error:
        Model.load(path)
    assert str(path) in str(error.value)
    assert "actum train" in str(error.value)
    return str(error.value)


def altered(path: Path, **changes: object) -> Path:
    """Write the file anew with some of its arrays changed, or dropped where None."""
    with np.load(path) as file:
        arrays = {**file, **changes}
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


def with_metadata(path: Path, **changes: object) -> Path:
    with np.load(path) as file:
        text = json.dumps({**json.loads(str(file["metadata"])), **changes})
    return altered(path, metadata=np.array(text))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    assert "no such file" in refused(tmp_path / "nothing.npz")


def test_a_folder_is_no_model(tmp_path: Path) -> None:
    refused(tmp_path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x93NUMPY\x01\x00", b"not a model", b"\x80\x04]\x94."])
def test_foreign_bytes_are_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "foreign").write_bytes(content)
    refused(tmp_path / "foreign")


def test_a_lone_array_is_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "array.npy", np.zeros(3))
    refused(tmp_path / "array.npy")


def test_pickled_objects_are_never_read(path: Path) -> None:
    refused(altered(path, layer2=np.array([{"a": 1}], dtype=object)))


@pytest.mark.parametrize(
    "changes",
    [
        {"metadata": None},
        {"layer3": None},
        {"metadata": np.array("{")},
        {"layer1": np.zeros((3, 3, 8))},
        {"layer1": np.zeros((9, 9))},
        {"layer1": np.full((3, 3, 9), np.nan)},
        {"layer1": np.full((3, 3, 9), "x")},
        {"layer2": np.zeros((1, 2, 8))},
        {"layer3": np.eye(3)},
        {"layer3": np.zeros((2, 2))},
    ],
)
def test_arrays_that_do_not_fit_are_refused(path: Path, changes: dict[str, object]) -> None:
    refused(altered(path, **changes))


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"format": "actum.model/2"}, "format"),
        ({"labels": []}, "labels"),
        ({"labels": ["push", "push"]}, "labels"),
        ({"points": "3"}, "points"),
        ({"contrast": 0.0}, "contrast"),
        ({"contrast": float("nan")}, "contrast"),
        ({"part": "tail"}, "tail"),
        ({"joint_order": ["head"]}, "joint order"),
        ({"seed": None}, "seed"),
    ],
)
def test_metadata_that_do_not_fit_are_named(path: Path, changes: dict[str, object], named: str) -> None:
    assert named in refused(with_metadata(path, **changes))


def test_metadata_of_later_versions_are_ignored(path: Path) -> None:
    assert Model.load(with_metadata(path, later="field")).labels == ["pull", "push"]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_cut_or_altered_file_is_refused_or_whole(path: Path, data: st.DataObject) -> None:
    two_way_model().save(path)
    content = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    else:
        content[data.draw(st.integers(0, len(content) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(content)
    try:
        loaded = Model.load(path)
    except ModelError:
        return
    assert loaded.id == two_way_model().id
