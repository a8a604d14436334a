"""The program where OpenCV is not installed, as in the image of router, trainer and watch."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from actum.installing import install_command

WITHOUT = """
import json, sys
from importlib.machinery import PathFinder

class Without(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name in {"cv2", "reportlab", "PIL"} else super().find_spec(name, path, target)

sys.meta_path[:] = [Without if finder is PathFinder else finder for finder in sys.meta_path]
from actum_command.__main__ import app
from typer.testing import CliRunner

for arguments in json.loads(sys.argv[1]):
    ended = CliRunner().invoke(app, arguments)
    print(json.dumps([ended.exit_code, ended.stdout, ended.stderr]))
"""
"""Runs commands one after the other, and prints how each ended."""
NAMES = ("import", "draw", "markers", "calibrate")
WORKING = ("router", "up", "doctor", "watch", "train", "record")


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scene") / "scene.mcap"


@pytest.fixture(scope="module")
def ended(scene: Path) -> dict[str, tuple[int, str, str]]:
    """Exit code, output and errors of each command, by its name."""
    needing = [[name, "somewhere.yaml", "--board", "5x7"] for name in NAMES]
    commands = [*needing, *([name, "--help"] for name in WORKING), ["simulate", str(scene), "--repetitions", "1"]]
    program = [sys.executable, "-c", WITHOUT, json.dumps(commands)]
    printed = subprocess.run(program, check=True, capture_output=True, text=True).stdout
    return {command[0]: tuple(json.loads(line)) for command, line in zip(commands, printed.splitlines(), strict=True)}


@pytest.mark.parametrize("name", NAMES)
def test_what_needs_it_says_what_to_install(ended: dict[str, tuple[int, str, str]], name: str) -> None:
    code, _, errors = ended[name]
    assert code == 1
    assert install_command("actum-command") in errors


@pytest.mark.parametrize("command", WORKING)
def test_what_needs_none_works(ended: dict[str, tuple[int, str, str]], command: str) -> None:
    code, output, errors = ended[command]
    assert code == 0, errors
    assert "Usage" in output


def test_a_scene_without_images_is_simulated(ended: dict[str, tuple[int, str, str]], scene: Path) -> None:
    code, _, errors = ended["simulate"]
    assert code == 0, errors
    assert scene.stat().st_size > 0
