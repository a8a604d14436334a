"""What installs this package works wherever it came from, and fetches nothing by a name that is not ours."""

import json
import re
import shlex
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from actum import installing

Tell = Callable[..., None]
ROOT = Path(__file__).parents[2]
FROM_AN_INDEX = re.compile(
    r"""\bactum\[[^\]\n]*\](?!\ @)                              # a requirement, but for one that says where it lies
    |\b(?:pip3?|pipx|uv|uvx)\ (?:[\w-]+\ )*?(?:install|add|run|download)\ (?:-\S+\ )*['"]?actum\b(?![/_])
    |\b(?:npx|npm\ install|brew\ install|conda\ install|cargo\ install|uvx)\ (?:-\S+\ )*actum
    |\b(?:docker|podman)\ (?:run|pull|create)\ (?!.*--pull[ =]never).*\bactum/\w
    """,
    re.VERBOSE,
)
"""What fetches from a public registry by the name of this project."""
OF_ITSELF = {"pyproject.toml"}
"""Files in which extras name each other, which pip looks up in what it installs already."""


@pytest.fixture
def came_from(monkeypatch: pytest.MonkeyPatch) -> Tell:
    """Let pip have written down where the package came from."""

    def tell(**told: object) -> None:
        written = SimpleNamespace(read_text=lambda _name: json.dumps(told) if told else None)
        monkeypatch.setattr(installing, "distribution", lambda _package: written)

    return tell


def tracked() -> list[Path]:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / name for name in listed.stdout.splitlines() if "vendored/" not in name]


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="git tells which files are the project's")
def test_no_page_help_script_or_file_has_the_project_fetched_by_its_name() -> None:
    found = []
    for file in tracked():
        if file.name in OF_ITSELF or file == Path(__file__):
            continue
        try:
            lines = file.read_text(encoding="utf-8").splitlines()
        except (UnicodeDecodeError, FileNotFoundError):
            continue
        found += [
            f"{file.relative_to(ROOT)}:{n}: {line}" for n, line in enumerate(lines, 1) if FROM_AN_INDEX.search(line)
        ]
    assert found == []


@pytest.mark.parametrize(
    ("found", "line"),
    [
        (True, "pip install 'actum[view]'"),
        (True, "pip install --upgrade actum"),
        (True, "needs `actum[camera]`"),
        (True, "sudo /opt/actum/bin/pip install actum==0.1.0"),
        (True, "uv pip install actum"),
        (True, "pipx install actum"),
        (True, "uvx actum up"),
        (True, "docker run --rm actum/som_classifier"),
        (False, "pip install '.[view]'"),
        (False, "pip install 'dist/actum-0.1.0-py3-none-any.whl[all]'"),
        (False, 'f"actum[all] @ {wheel.as_uri()}"'),
        (False, "pip install eclipse-zenoh msgpack and nothing of actum"),
        (False, "docker build -t actum/som_classifier ."),
        (False, "docker run --pull never actum/som_classifier"),
    ],
)
def test_what_the_search_finds(found: bool, line: str) -> None:
    assert bool(FROM_AN_INDEX.search(line)) == found


@pytest.mark.parametrize(
    ("written_by_pip", "flags"),
    [({"archive_info": {}}, []), ({"dir_info": {}}, []), ({"dir_info": {"editable": True}}, ["-e"])],
)
def test_what_came_from_a_wheel_or_a_folder_is_completed_from_it(
    came_from: Tell, tmp_path: Path, written_by_pip: dict[str, object], flags: list[str]
) -> None:
    origin = tmp_path / "a folder"
    origin.mkdir()
    came_from(url=origin.as_uri(), **written_by_pip)
    assert shlex.split(installing.install_command("view")) == ["pip", "install", *flags, f"{origin}[view]"]


@pytest.mark.parametrize("told", [{}, {"url": "https://example.org/actum.git"}, {"url": "file:///build"}])
def test_where_the_origin_is_gone_the_repository_is_named(came_from: Tell, told: dict[str, str]) -> None:
    came_from(**told)
    assert installing.install_command("view") == "pip install '.[view]' in the folder of actum's repository"


def test_one_line_publishes_it(came_from: Tell, monkeypatch: pytest.MonkeyPatch) -> None:
    came_from()
    monkeypatch.setattr(installing, "INDEX_NAME", "an-actum")
    assert (
        installing.install_command("view")
        == installing.pip_install("view", installing.WHEEL)
        == "pip install 'an-actum[view]'"
    )
