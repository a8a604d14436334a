"""A model's file brings back the same model of its kind, or is refused by name."""

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from actum import __version__
from actum.som import Som
from handmade import KINDS, model_of, paper_model, pyramid_model
from som_classifier.convolutions import FILTERS
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, load_model

each_kind = pytest.mark.parametrize("kind", KINDS)


def saved(folder: Path, kind: str, **changes: object) -> Path:
    path = folder / "model.npz"
    model_of(kind, **changes).save(path)
    return path


def refused(path: Path) -> str:
    with pytest.raises(ModelError) as error:
        load_model(path)
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


@each_kind
def test_a_file_brings_back_the_same_model(tmp_path: Path, kind: str) -> None:
    model, loaded = model_of(kind), load_model(saved(tmp_path, kind))
    assert type(loaded) is type(model) is KINDS[kind]
    assert loaded.id == model.id
    assert json.loads(loaded.metadata.model_dump_json()) == json.loads(model.metadata.model_dump_json())
    for name, array in model.arrays.items():
        assert loaded.arrays[name].dtype == array.dtype
        np.testing.assert_array_equal(loaded.arrays[name], array)


@each_kind
def test_the_description_tells_what_it_is(kind: str) -> None:
    model = model_of(kind)
    assert (model.labels, model.metadata.kind, model.metadata.persons) == (["pull", "push"], kind, ["1", "3"])


def test_the_id_changes_with_weights_with_metadata_and_with_the_kind() -> None:
    paper, pyramid = paper_model(), pyramid_model()
    moved: list[Model] = [
        replace(paper, layer1=Som(3, 3, paper.layer1.weights + 1e-12)),
        replace(pyramid, stages=replace(pyramid.stages, offsets=np.nextafter(pyramid.stages.offsets, np.float32(9)))),
    ]
    models = [paper, pyramid, *moved, paper_model(seed=8), pyramid_model(seed=8)]
    assert len({model.id for model in models}) == 6


@each_kind
def test_saving_leaves_nothing_but_the_file(tmp_path: Path, kind: str) -> None:
    saved(tmp_path, kind)
    path = saved(tmp_path, kind, seed=8)
    assert list(tmp_path.iterdir()) == [path]
    assert load_model(path).metadata.seed == 8


@each_kind
def test_a_save_that_fails_leaves_the_old_file(tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError("No space left on device")

    path = saved(tmp_path, kind)
    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space"):
        model_of(kind, seed=8).save(path)
    assert list(tmp_path.iterdir()) == [path]
    assert load_model(path).metadata.seed == 7


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    assert "does not exist" in refused(tmp_path / "nothing.npz")


def test_a_folder_is_no_model(tmp_path: Path) -> None:
    refused(tmp_path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x93NUMPY\x01\x00", b"not a model", b"\x80\x04]\x94."])
def test_foreign_bytes_are_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "foreign").write_bytes(content)
    refused(tmp_path / "foreign")


def test_a_lone_array_is_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "array.npy", np.zeros(3))
    refused(tmp_path / "array.npy")


@pytest.mark.parametrize("metadata", ["", "{", "3", "[]", "null", '"pyramid"', "[" * 100_000, "{}"])
def test_metadata_that_are_no_map_of_ours_are_refused(tmp_path: Path, metadata: str) -> None:
    refused(altered(saved(tmp_path, "pyramid"), metadata=np.array(metadata)))


@pytest.mark.parametrize("kind", ["tree", None, 3])
def test_an_unknown_kind_is_named(tmp_path: Path, kind: object) -> None:
    assert f"of kind {kind!r}" in refused(with_metadata(saved(tmp_path, "pyramid"), kind=kind))


@pytest.mark.parametrize("kind", [["pyramid"], {}])
def test_what_is_no_kind_at_all_is_refused(tmp_path: Path, kind: object) -> None:
    refused(with_metadata(saved(tmp_path, "pyramid"), kind=kind))


def test_a_kind_that_is_not_the_arrays_is_refused(tmp_path: Path) -> None:
    for kind, other in (("paper", "pyramid"), ("pyramid", "paper")):
        refused(with_metadata(saved(tmp_path, kind), kind=other))


@pytest.mark.parametrize(("kind", "name"), [("paper", "layer2"), ("pyramid", "axes"), ("pyramid", "postures")])
def test_pickled_objects_are_never_read(tmp_path: Path, kind: str, name: str) -> None:
    refused(altered(saved(tmp_path, kind), **{name: np.array([{"a": 1}], dtype=object)}))


def with_headers(path: Path, old: bytes, new: bytes) -> Path:
    """Write the archive anew, sound in itself, with something else in the headers of its arrays."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            header = content[10:128].replace(old, new).rstrip().ljust(117) + b"\n"
            archive.writestr(name, content[:10] + header + content[128:])
    return path


@pytest.mark.parametrize(
    ("old", "new"), [(b"}", b""), (b"'<", b"'(01,)"), (b"(", b"(9" + 25 * b"9" + b", "), (b"'", b"\xff")]
)
def test_headers_that_numpy_cannot_read_are_refused(tmp_path: Path, old: bytes, new: bytes) -> None:
    refused(with_headers(saved(tmp_path, "pyramid"), old, new))


SINGLE = np.float32
OF_COMPLETE_SEGMENTS = (
    "convolved",
    "convolution_biases",
    "opinion_axes",
    "opinion_offsets",
    "verifier_axes",
    "verifier_convolution_axes",
    "verifier_offsets",
)
FLAT_BIASES = {
    "convolution_biases": np.zeros(FILTERS, SINGLE),
    "opinion_axes": np.zeros((FILTERS, 2), SINGLE),
    "verifier_convolution_axes": np.zeros((FILTERS, 2), SINGLE),
}
"""They fit together, and not to the filters."""
MISFITS: list[tuple[str, dict[str, object]]] = [
    ("paper", {"metadata": None}),
    ("paper", {"layer3": None}),
    ("paper", {"layer1": np.zeros((3, 3, 8))}),
    ("paper", {"layer1": np.zeros((9, 9))}),
    ("paper", {"layer1": np.full((3, 3, 9), np.nan)}),
    ("paper", {"layer1": np.full((3, 3, 9), "x")}),
    ("paper", {"layer2": np.zeros((1, 2, 8))}),
    ("paper", {"layer3": np.eye(3)}),
    ("paper", {"layer3": np.zeros((2, 2))}),
    ("pyramid", {"metadata": None}),
    ("pyramid", FLAT_BIASES),
    *(("pyramid", {name: None}) for name in pyramid_model().arrays),
    *(("pyramid", {name: np.zeros((3, 3, 44), SINGLE)}) for name in ("postures", "velocities", "arms", "concepts")),
    *(("pyramid", {name: np.zeros((9, 45), SINGLE)}) for name in ("postures", "velocities", "arms", "concepts")),
    *(("pyramid", {name: np.full((3, 3, 45), np.nan, SINGLE)}) for name in ("postures", "velocities")),
    ("pyramid", {"arms": np.full((3, 3, 12), np.nan, SINGLE)}),
    ("pyramid", {"arms": np.zeros((2, 3, 12), SINGLE)}),
    ("pyramid", {"postures": np.zeros((4, 3, 45), SINGLE)}),
    ("pyramid", {"concepts": np.zeros((2, 3, 2), SINGLE)}),
    ("pyramid", {"layer3": np.eye(2)}),
    ("pyramid", {"layer3": np.zeros((2, 9))}),
    *(
        ("pyramid", {name: make(pyramid_model().arrays[name])})
        for name in ("axes", "offsets", "concept_mean", *OF_COMPLETE_SEGMENTS)
        for make in (
            lambda array: array[:-1],
            lambda array: array[..., None],
            lambda array: np.full_like(array, np.nan),
            lambda array: np.full(array.shape, "x"),
            lambda array: array.astype(np.complex64),
        )
    ),
]


@pytest.mark.parametrize(
    ("kind", "changes"), MISFITS, ids=lambda value: value if isinstance(value, str) else next(iter(value))
)
def test_arrays_that_do_not_fit_are_refused(tmp_path: Path, kind: str, changes: dict[str, object]) -> None:
    refused(altered(saved(tmp_path, kind), **changes))


NAN, INFINITE = float("nan"), float("inf")
EITHER: list[tuple[dict[str, object], str]] = [
    ({"format": "actum.model/2"}, "format"),
    ({"labels": []}, "labels"),
    ({"labels": ["push", "push"]}, "labels"),
    ({"joint_order": ["head"]}, "joint order"),
    ({"seed": None}, "seed"),
]
OF_PAPER: list[tuple[dict[str, object], str]] = [
    ({"points": "3"}, "points"),
    ({"contrast": 0.0}, "contrast"),
    ({"contrast": NAN}, "contrast"),
    ({"attention": "tail"}, "tail"),
    ({"axes": "camera"}, "axes"),
    ({"origin": "head"}, "origin"),
    ({"attention": "all"}, "45"),
    ({"centre_contrast": 0.0}, "centre_contrast"),
]
OF_PYRAMID: list[tuple[dict[str, object], str]] = [
    ({"posture_contrast": 0.0}, "posture_contrast"),
    ({"velocity_contrast": NAN}, "velocity_contrast"),
    ({"arm_contrast": -1.0}, "arm_contrast"),
    ({"arm_shares": [0.0, 0.1]}, "arm_shares"),
    ({"concept_contrast": INFINITE}, "concept_contrast"),
    ({"levels": []}, "levels"),
    ({"levels": [0]}, "levels"),
    ({"levels": [1, 3]}, "discriminant axes"),
    ({"levels": [10**12]}, "discriminant axes"),
    ({"overlap": -0.1}, "overlap"),
    ({"overlap": NAN}, "overlap"),
    ({"fractions": []}, "fractions"),
    ({"fractions": [0.0, 1.0]}, "fractions"),
    ({"fractions": [1.0]}, "stages"),
    ({"log_duration_mean": NAN}, "log_duration_mean"),
    ({"log_duration_sd": 0.0}, "log_duration_sd"),
    ({"gains": [4.0]}, "stages"),
    ({"gains": [4.0, -1.0]}, "gains"),
    ({"verification": [10.0, NAN]}, "verification"),
    ({"verification": [10.0]}, "verification"),
    ({"least_likeness": NAN}, "least_likeness"),
    ({"least_found_likeness": NAN}, "least_found_likeness"),
    ({"opinion_weight": -0.5}, "opinion_weight"),
    ({"usual_log_errors": [0.0, NAN]}, "usual_log_errors"),
    ({"usual_log_errors": [0.0]}, "do not fit"),
    ({"usual_movements": [[0.0, 0.0]]}, "do not fit"),
    ({"usual_movements": [[0.0, NAN], [0.0, 0.0]]}, "usual_movements"),
    ({"most_movement_above": [1.0]}, "most_movement_above"),
    ({"least_movement_m": -0.1}, "least_movement_m"),
    ({"least_movement_m": NAN}, "least_movement_m"),
    ({"labels": ["lift", "pull", "push"]}, "not"),
]


@pytest.mark.parametrize(
    ("kind", "changes", "named"),
    [
        *((kind, *case) for kind in KINDS for case in EITHER),
        *(("paper", *case) for case in OF_PAPER),
        *(("pyramid", *case) for case in OF_PYRAMID),
    ],
)
def test_metadata_that_do_not_fit_are_named(tmp_path: Path, kind: str, changes: dict[str, object], named: str) -> None:
    assert named in refused(with_metadata(saved(tmp_path, kind), **changes))


@pytest.mark.parametrize(
    ("kind", "change", "detail"),
    [
        ("paper", {"points": 4}, "its maps take vectors of 9 and 6, not of 9 and 8"),
        ("pyramid", {"levels": [1, 3]}, "its discriminant axes is of shape"),
        ("pyramid", {"arm_contrast": None}, "metadata arm_contrast"),
    ],
)
def test_a_model_that_another_version_made_otherwise_names_that_version(
    tmp_path: Path, kind: str, change: dict[str, object], detail: str
) -> None:
    told = refused(with_metadata(saved(tmp_path, kind), actum_version="0.0.9", **change))
    assert f"actum 0.0.9 made the model, and actum {__version__} cannot use this model ({detail}" in told
    assert "train a new model from the same recordings with 'actum train" in told
    assert "damaged" not in told


def test_a_model_that_another_version_made_and_that_lacks_an_array_names_that_version(tmp_path: Path) -> None:
    assert "actum 0.0.9 made" in refused(
        altered(with_metadata(saved(tmp_path, "pyramid"), actum_version="0.0.9"), arms=None)
    )


@pytest.mark.parametrize("version", ["", "1\n2", "9" * 42, None, ["0.0.9"]])
def test_what_is_no_version_is_not_repeated(tmp_path: Path, version: object) -> None:
    told = refused(with_metadata(saved(tmp_path, "pyramid"), actum_version=version, levels=[1, 3]))
    assert "made the model" not in told


@each_kind
def test_metadata_of_later_versions_are_ignored(tmp_path: Path, kind: str) -> None:
    assert load_model(with_metadata(saved(tmp_path, kind), later="field")).labels == ["pull", "push"]


@each_kind
@pytest.mark.parametrize("label", ["x" * 201, None, 5])
def test_a_label_that_no_action_can_hold_is_refused(tmp_path: Path, kind: str, label: object) -> None:
    assert "metadata labels" in refused(with_metadata(saved(tmp_path, kind), labels=[label, "push"]))
