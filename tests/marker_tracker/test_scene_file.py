"""The scene file says which object carries which markers, and whatever is wrong in it is named with its line."""

from pathlib import Path

import numpy as np
import pytest

from marker_tracker.node import MarkerTracker
from marker_tracker.scene_file import SceneFileError, load
from marker_tracker.settings import ObjectSpec, Settings

EXAMPLE = Path(__file__).parents[2] / "deploy" / "objects.example.yaml"


def scene(folder: Path, text: str) -> Path:
    path = folder / "objects.yaml"
    path.write_text(text)
    return path


def test_the_example_can_be_used() -> None:
    catalogue = load(EXAMPLE)
    assert catalogue.names == {1: "cup", 2: "book", 3: "box"}
    assert catalogue.wanted() == {"DICT_4X4_50": {1, 7}, "DICT_APRILTAG_36H11": {10, 11, 12}}
    assert [catalogue.find(*key).size_m for key in (("DICT_4X4_50", 7), ("DICT_APRILTAG_36H11", 12))] == [0.08, 0.04]


def test_what_an_object_leaves_out_is_the_files() -> None:
    cup = load(EXAMPLE).find("DICT_4X4_50", 1)
    assert (cup.object_id, cup.size_m) == (1, 0.08)
    assert np.array_equal(cup.object_from_marker, np.eye(4))


def test_a_placement_turns_about_x_then_y_then_z(tmp_path) -> None:
    text = "family: 4x4_50\nsize_m: 0.1\nobjects:\n  5:\n    name: box\n    markers:\n      - id: 2\n        "
    placed = "object_from_marker: {translation_m: [1, 2, 3], rotation_deg: [90, 0, 90]}\n"
    marker = load(scene(tmp_path, text + placed)).find("DICT_4X4_50", 2)
    # About x, z goes to -y; about z, -y goes to x.
    assert np.allclose(marker.object_from_marker @ [0, 0, 1, 1], [1 + 1, 2, 3, 1])


GOOD = "family: 4X4_50\nsize_m: 0.08\nobjects:\n  1: {name: cup}\n"
BAD = {
    "objects:\n  1: {name: cup, size_m: 0.1}\n": (
        "line 2: objects.1: this entry of the scene file has no `family`: add `family` to the entry"
    ),
    "family: 4X4_50\nobjects:\n  1: {name: cup}\n": (
        "line 3: objects.1: this entry of the scene file has no `size_m`: add `size_m` to the entry"
    ),
    "family: 9X9\nsize_m: 0.1\nobjects:\n  1: {name: cup}\n": "line 1: family: '9X9' is not a marker dictionary: use",
    "family: 4X4_50\nsize_m: -1\nobjects:\n  1: {name: cup}\n": "line 2: size_m: Input should be greater than 0",
    GOOD + "  2: {nmae: box}\n": "line 5: objects.2.nmae: there is no such field: remove it or correct its spelling",
    GOOD + "  2: {size_m: 0.1}\n": "line 5: objects.2.name: is missing: add it",
    GOOD + "  1: {name: box}\n": "line 5: the key 1 occurs twice: remove one",
    GOOD + "  01: {name: box}\n": "line 5: the key 1 occurs twice: remove one",
    GOOD + "  2: box\n": "line 5: objects.2: has to have fields, such as {name: cup}",
    "family: 4X4_50\nobjects: [cup]\n": "line 2: objects: has to map ids to objects",
    GOOD + "  2: {name: box, markers: [{id: 2, object_from_marker: {translation_m: [0, 0, 35]}}]}\n": "equal to 5",
    GOOD + "  2: {name: box, markers: [{id: 1}]}\n": (
        "marker 1 of the family DICT_4X4_50 already belongs to object 1: give object"
    ),
    GOOD
    + "  60: {name: box}\n": "line 5: objects.60: the dictionary DICT_4X4_50 has no marker 60: use ids from 0 to 49",
    GOOD + "  2: {name: box, family: 4X4_100}\n": "DICT_4X4_100 and DICT_4X4_50 contain the same markers: use",
    GOOD
    + "  2:\n    name: box\n    markers:\n      - id: -3\n": "line 8: objects.2.markers.0.id: Input should be greater",
    GOOD + "  cup: {name: box}\n": "line 5: objects.cup: Input should be a valid integer",
    "family: 4X4_50\n": "objects: is missing: add it",
    "": "is not a scene file: add `objects:`",
    "[1, 2]": "is not a scene file: add `objects:`",
    "a: [1": "is not YAML",
    "a: !!int foo": "is not YAML",
    'a: !!int ""': "is not YAML",
    "a: 2026-13-45": "is not YAML",
    "[\n" * 3000: "is not YAML",
    "objects: &all\n  1: *all\n": "contains a YAML alias (*name) that refers to itself",
    "a0: &a0 [x]\n"
    + "".join(f"a{n + 1}: &a{n + 1} [{f'*a{n}, ' * 9}]\n" for n in range(9)): "a0: there is no such field",
}


@pytest.mark.parametrize(("text", "complaint"), BAD.items())
def test_what_is_wrong_is_named(tmp_path, text, complaint) -> None:
    with pytest.raises(SceneFileError) as error:
        load(scene(tmp_path, text))
    assert complaint in str(error.value)
    assert "objects.yaml" in str(error.value)


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(SceneFileError, match=r"objects\.yaml cannot be read"):
        load(tmp_path / "objects.yaml")


def test_the_scene_comes_from_the_environment(monkeypatch, image_of, pose_at) -> None:
    monkeypatch.setenv("ACTUM_SCENE", str(EXAMPLE))
    (answer,) = MarkerTracker(Settings()).handle(image_of([(1, 0.08, pose_at((0.1, 0.0, 0.8)))]))
    (cup,) = answer.objects
    assert (cup.id, cup.name) == (1, "cup")
    assert np.allclose(cup.position_m, [0.1, 0.0, 0.8], atol=0.01)


def test_a_scene_and_plain_objects_exclude_each_other() -> None:
    with pytest.raises(SceneFileError, match="set only one of the two"):
        MarkerTracker(Settings(scene=EXAMPLE, objects={1: ObjectSpec(name="cup")}))


@pytest.mark.parametrize("number", [60, 2**31, -3])
def test_plain_objects_must_be_in_the_dictionary_too(number: int) -> None:
    with pytest.raises(ValueError, match=f"DICT_4X4_50 has no marker {number}: use ids from 0 to 49"):
        MarkerTracker(Settings(dictionary="DICT_4X4_50", objects={number: ObjectSpec(name="cup")}))
