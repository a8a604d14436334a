"""The scene: which object carries which markers, from `objects.yaml` or the plain settings.

Errors name the file, the line and the field.
"""

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from actum.arrays import Array
from actum.calibration import YAML_ERRORS
from marker_tracker.detection.families import UnknownMarkerError, canonical, family
from marker_tracker.detection.marker import Key
from marker_tracker.pose.catalogue import Catalogue, MountedMarker
from marker_tracker.settings import Settings

Degrees = Annotated[FiniteFloat, Field(ge=-360, le=360)]
Metres = Annotated[FiniteFloat, Field(ge=-5, le=5)]
FamilyName = Annotated[str, AfterValidator(canonical)]
Size = Annotated[float, Field(gt=0, le=10)]
Location = tuple[str | int, ...]
"""Keys and indices that lead from the file's root to a field."""

INTEGER = "tag:yaml.org,2002:int"
"""YAML's tag of integers: `1` and `0x1` are the same key."""


class SceneFileError(ValueError):
    """A scene file that cannot be used; the message names file, line and field, and what to do."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Placement(_Part):
    """Pose of a marker in its object's frame: position of its centre, and rotations about fixed x, then y, then z."""

    translation_m: Annotated[list[Metres], Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]
    rotation_deg: Annotated[list[Degrees], Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]

    def transform(self) -> Array:
        """Build object_from_marker: a rigid transform (4, 4), in metres."""
        object_from_marker = np.eye(4)
        for axis, degrees in zip(np.eye(3), self.rotation_deg, strict=True):
            object_from_marker[:3, :3] = cv2.Rodrigues(axis * np.radians(degrees))[0] @ object_from_marker[:3, :3]
        object_from_marker[:3, 3] = self.translation_m
        return object_from_marker


class MarkerEntry(_Part):
    """One marker of an object; family and size default to the object's, then to the file's."""

    id: int = Field(ge=0)
    family: FamilyName | None = None
    size_m: Size | None = None
    object_from_marker: Placement = Placement()


class ObjectEntry(_Part):
    """One object; without `markers` it carries the marker of its own id, in its centre."""

    name: str = Field(min_length=1, max_length=200)
    family: FamilyName | None = None
    size_m: Size | None = None
    markers: Annotated[list[MarkerEntry], Field(min_length=1, max_length=64)] | None = None


class SceneFile(_Part):
    """Content of a scene file; family and size are defaults for all markers."""

    family: FamilyName | None = None
    size_m: Size | None = None
    objects: dict[Annotated[int, Field(ge=0, lt=2**31)], ObjectEntry] = Field(min_length=1, max_length=1024)


def catalogue(settings: Settings) -> Catalogue:
    """Build the catalogue of markers and objects, from the scene file if the settings name one, else from the settings.

    Raises:
        SceneFileError: the scene file cannot be read or used, or the settings describe objects as well.
        UnknownMarkerError: the settings name a marker that their dictionary does not have.
    """
    if settings.scene is None:
        name = canonical(settings.dictionary)
        if not settings.objects:
            return Catalogue((name,), {}, {}, settings.marker_size_m)
        ids = len(family(name).codes)
        for number in settings.objects:
            if not 0 <= number < ids:
                raise UnknownMarkerError(
                    f"objects: the dictionary {name} has no marker {number}: use ids from 0 to {ids - 1}"
                )
        markers = {
            (name, number): MountedMarker(number, spec.size_m or settings.marker_size_m)
            for number, spec in settings.objects.items()
        }
        return Catalogue((name,), markers, {number: spec.name for number, spec in settings.objects.items()})
    if settings.objects:
        raise SceneFileError(
            "the settings 'scene' and 'objects' both define which object carries which marker: set only one of the two"
        )
    return load(settings.scene)


def load(path: Path) -> Catalogue:
    """Read a scene file into a catalogue.

    Raises:
        SceneFileError: it cannot be read or used.
    """
    try:
        root = yaml.compose(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
        content = yaml.SafeLoader("").construct_document(root) if root is not None else None
    except (OSError, UnicodeDecodeError) as error:
        raise SceneFileError(f"{path} cannot be read as text ({error}): give a text file in UTF-8") from None
    except YAML_ERRORS as error:
        raise SceneFileError(f"{path} is not YAML: {' '.join(str(error).split())}") from None
    if root is None or not isinstance(content, dict):
        raise SceneFileError(f"{path} is not a scene file: add `objects:` with an id and a name for each object")
    try:
        _refuse_repeated_keys(path, root, set())
        scene = SceneFile.model_validate(content)
    except RecursionError:
        raise SceneFileError(
            f"{path} contains a YAML alias (*name) that refers to itself, because it is inside the value that &name "
            "defines: remove this alias"
        ) from None
    except ValidationError as error:
        raise SceneFileError("; ".join(_problem(path, root, each) for each in error.errors())) from None
    return _from_scene(path, root, scene)


def _from_scene(path: Path, root: yaml.Node, scene: SceneFile) -> Catalogue:
    markers: dict[Key, MountedMarker] = {}
    for location, key, mounted in _mounted_markers(path, root, scene):
        owner, (family_name, marker_id) = markers.get(key), key
        if owner is not None:
            raise _refusal(
                path,
                root,
                location,
                f"marker {marker_id} of the family {family_name} already belongs to object {owner.object_id}: give "
                f"object {mounted.object_id} another marker",
            )
        markers[key] = mounted
    families = tuple(sorted({name for name, _ in markers}))
    for one, other in combinations(families, 2):
        if family(one).cells == family(other).cells and family(one).codes[0, 0] == family(other).codes[0, 0]:
            raise SceneFileError(
                f"{path}: the dictionaries {one} and {other} contain the same markers: use only the larger dictionary"
            )
    return Catalogue(families, markers, {number: entry.name for number, entry in scene.objects.items()})


def _mounted_markers(path: Path, root: yaml.Node, scene: SceneFile) -> Iterator[tuple[Location, Key, MountedMarker]]:
    """Yield each marker's location in the file, its key and its mounting; fill in default families and sizes."""
    for number, entry in scene.objects.items():
        for index, marker in enumerate(entry.markers or [MarkerEntry(id=number)]):
            location: Location = ("objects", number) + (("markers", index) if entry.markers else ())
            name = marker.family or entry.family or scene.family
            size_m = marker.size_m or entry.size_m or scene.size_m
            if name is None or size_m is None:
                field = "family" if name is None else "size_m"
                raise _refusal(
                    path,
                    root,
                    location,
                    f"this entry of the scene file has no `{field}`: add `{field}` to the entry, or to the top level "
                    "of the file as the default of all entries",
                )
            ids = len(family(name).codes)
            if marker.id >= ids:
                raise _refusal(
                    path,
                    root,
                    location,
                    f"the dictionary {name} has no marker {marker.id}: use ids from 0 to {ids - 1}",
                )
            yield location, (name, marker.id), MountedMarker(number, size_m, marker.object_from_marker.transform())


def _refuse_repeated_keys(path: Path, node: yaml.Node, done: set[yaml.Node]) -> None:
    """Raise an error for a key that comes twice; what is `done` is not looked at again, however many `*` name it."""
    if node in done:
        return
    if isinstance(node, yaml.MappingNode):
        names: set[str] = set()
        for key, value in node.value:
            name = str(yaml.SafeLoader("").construct_object(key)) if key.tag == INTEGER else key.value
            if name in names:
                raise SceneFileError(
                    f"{path}, line {key.start_mark.line + 1}: the key {name} occurs twice: remove one of the two"
                )
            names.add(name)
            _refuse_repeated_keys(path, value, done)
    elif isinstance(node, yaml.SequenceNode):
        for value in node.value:
            _refuse_repeated_keys(path, value, done)
    done.add(node)


def _problem(path: Path, root: yaml.Node, error: Any) -> str:
    advice = {
        "extra_forbidden": "there is no such field: remove it or correct its spelling",
        "missing": "is missing: add it",
        "dict_type": "has to map ids to objects or markers, such as `1: {name: cup}`",
        "model_type": "has to have fields, such as {name: cup} for an object and {id: 3} for a marker",
    }
    problem = advice.get(error["type"], error["msg"].removeprefix("Value error, "))
    return str(_refusal(path, root, error["loc"], problem))


def _refusal(path: Path, root: yaml.Node, location: Location, problem: str) -> SceneFileError:
    field = ".".join(str(part) for part in location if part != "[key]")
    return SceneFileError(f"{path}, line {_line(root, location)}: {field}: {problem}")


def _line(node: yaml.Node, location: Location) -> int:
    """Find the line of a location, or of the deepest part of the location that the file has."""
    for part in location:
        if isinstance(node, yaml.MappingNode):
            inner = [(key, value) for key, value in node.value if key.value == str(part)]
            if not inner:
                break
            key, node = inner[0]
            if isinstance(node, yaml.ScalarNode):
                return int(key.start_mark.line) + 1
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
    return int(node.start_mark.line) + 1
