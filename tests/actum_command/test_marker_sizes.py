"""A marker taken for another size is seen at a wrong distance: all that name a size by themselves name the same."""

import re
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from actum_command.__main__ import app
from marker_tracker.settings import Settings
from scene_simulator.parameters import load_parameters

ROOT = Path(__file__).parents[2]
USUAL_M = Settings.model_fields["marker_size_m"].default
PAGES = [(ROOT / page).read_text() for page in ("README.md", "docs/objects.md")]
EXAMPLE = (ROOT / "deploy" / "objects.example.yaml").read_text()


def test_what_is_printed_is_what_the_tracker_expects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    printed_mm: list[float] = []

    def sheet(_family: str, _ids: list[int], size_mm: float, _paper: str) -> bytes:
        printed_mm.append(size_mm)
        return b"PDF"

    monkeypatch.setattr("actum_calibrator.marker_sheet.marker_sheet", sheet)
    assert CliRunner().invoke(app, ["markers", "-o", str(tmp_path / "m.pdf")]).exit_code == 0
    assert printed_mm == [1000 * USUAL_M]


def test_the_simulated_objects_carry_the_usual_size() -> None:
    assert load_parameters().objects.marker_size_m == USUAL_M


def test_the_pages_print_what_the_example_of_a_scene_file_expects() -> None:
    for page in PAGES:
        (printed_mm,) = re.findall(r"actum markers -o markers.pdf .*--size-mm (\d+)", page)
        assert float(printed_mm) / 1000 == yaml.safe_load(EXAMPLE)["size_m"] == USUAL_M
    (told_m,) = re.findall(r"# family, size \(([\d.]+) m here\)", "".join(PAGES))
    assert float(told_m) == USUAL_M


def test_the_example_of_a_scene_file_says_how_its_own_markers_are_printed() -> None:
    (printed_mm,) = re.findall(r"actum markers -o markers.pdf --ids 1,7 --size-mm (\d+)", EXAMPLE)
    assert float(printed_mm) / 1000 == USUAL_M
