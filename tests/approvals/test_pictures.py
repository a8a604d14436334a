"""What stands in pictures: lines, colours and texts of the SVG files, and the calls that draw pixels."""

import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from actum.recording import Recording
from actum_command.recording_picture import write_picture
from actum_examples.take import read_take
from actum_model_inspector.answered import answered_segments
from actum_model_inspector.inspection import pictures, write
from actum_model_trainer.evaluation import evaluate
from approving import Approve
from performers import HAND_PATHS, performance
from recognisers import tiny_model
from unmarked import recorded, scene, spotting_model

NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
DRAWN = ("path", "text", "use", "svg", "image")
ALIKE = ("trace-lift", "time-lift", "trace-swing", "time-swing", "trace-mistake-1")
"""Pictures that show nothing which others do not show."""
MIXED = {"path fill": 1e-4, "path stroke": 1e-4}
"""Colours are mixed by cosines, which are rounded to 256 levels."""
NAMES = ("id", "href", "clip-path", "version")
"""Attributes that only name other elements, or the format."""


def drawn(svg: Path) -> dict[str, list[object]]:
    """Return the numbers and words of an SVG file by element and attribute."""
    found: dict[str, list[object]] = {}
    for element in ElementTree.parse(svg).iter():
        tag = element.tag.rpartition("}")[2]
        for name, text in attributes(element) if tag in DRAWN else ():
            found.setdefault(f"{tag} {name}", []).append(text if name == "text" else numbers_or_word(text))
    return found


def numbers_or_word(text: str) -> np.ndarray | str:
    if text.startswith("#"):
        return np.array([int(text[at : at + 2], 16) for at in (1, 3, 5)])
    numbers = [float(each) for each in NUMBER.findall(text)]
    return np.array(numbers) if numbers else text


def attributes(element: ElementTree.Element) -> Iterator[tuple[str, str]]:
    for name, value in element.items():
        if name == "style":
            yield from (each.split(": ") for each in value.split("; "))  # type: ignore[misc]
        elif name.rpartition("}")[2] not in NAMES:
            yield name, value
    if element.text and element.text.strip():
        yield "text", element.text


@pytest.fixture
def performed(tmp_path: Path) -> Recording:
    """Thirty actions, of which a push is labelled as lifting, which counts as a mistake of the model."""
    skeletons, marks = performance([*HAND_PATHS] * 10, height=1.1, seed=5)
    marks[2] = marks[2].model_copy(update={"label": "lift"})
    return recorded(tmp_path, "performance", [*skeletons, *marks], "2")


def test_a_model_is_drawn_as_approved(performed: Recording, tmp_path: Path, approve: Approve) -> None:
    model = tiny_model()
    segments = answered_segments(model, [performed])
    planned = [each for each in pictures(model, segments, evaluate(model, [performed])) if each.name not in ALIKE]
    folder = tmp_path / "pictures"
    folder.mkdir()
    files = write(planned, folder, "svg")
    approve("pictures", {name: drawn(folder / file) for name, file in files.items()}, 1e-6, besides=MIXED)


def test_a_recording_is_drawn_as_approved(tmp_path: Path, approve: Approve) -> None:
    of = scene(("lift", "push", "swing"), seed=9)
    recording = recorded(tmp_path, "scene", [*of.skeletons(), *of.marks()], "2")
    write_picture(read_take(recording), spotting_model(), tmp_path / "scene.svg")
    approve("picture-recording", drawn(tmp_path / "scene.svg"), 1e-6)
