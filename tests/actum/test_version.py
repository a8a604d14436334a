"""The version stands in pyproject.toml alone; the rest reads it from what is installed, or is held equal to it."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import yaml

import actum
from actum.node import Counters
from actum.runtime.reporting import Meter
from actum.settings import ServiceSettings

ROOT = Path(__file__).parents[2]
STATED = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]


def test_the_library_has_the_version_that_pyproject_states() -> None:
    assert actum.__version__ == STATED, "make install again: another version is installed"


def test_the_command_prints_it() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "actum_command", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"actum {STATED}\n"


def test_a_service_tells_it_in_info() -> None:
    assert Meter("pose_preprocessor", Counters(), ServiceSettings()).info().version == STATED


def test_no_source_file_states_it_again() -> None:
    sources = [file for folder in ("shared", "services") for file in (ROOT / folder).rglob("*.py")]
    stating = re.compile(rf"""^\s*\w*version\w* *[:=].*["']{re.escape(STATED)}["']""", re.MULTILINE | re.IGNORECASE)
    assert [file.name for file in sources if stating.search(file.read_text(encoding="utf-8"))] == []


def test_citation_and_changelog_name_it() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    releases = re.findall(r"^## \[(\d[^\]]*)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert citation["version"] == releases[0] == STATED
