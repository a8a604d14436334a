"""The program where OpenCV is not installed, as in the image of router, trainer and watch."""

import subprocess
import sys
from pathlib import Path

import pytest

from actum.installing import adding
from actum_command.commands.picture_commands import NAMES

WITHOUT = """
import sys
from importlib.machinery import PathFinder

class Without(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name in {"cv2", "reportlab", "PIL"} else super().find_spec(name, path, target)

sys.meta_path[:] = [Without if finder is PathFinder else finder for finder in sys.meta_path]
from actum_command.__main__ import main
main()
"""


def actum(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", WITHOUT, *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True)


@pytest.mark.parametrize("name", NAMES)
def test_what_needs_it_says_what_to_install(name: str) -> None:
    refused = actum(name, "somewhere.yaml", "--board", "5x7")
    assert refused.returncode == 1
    assert adding("actum-command") in refused.stderr


@pytest.mark.parametrize("command", ["router", "up", "doctor", "watch", "train", "record"])
def test_what_needs_none_works(command: str) -> None:
    explained = actum(command, "--help")
    assert explained.returncode == 0, explained.stderr
    assert "Usage" in explained.stdout


def test_a_scene_without_images_is_simulated(tmp_path: Path) -> None:
    done = actum("simulate", str(tmp_path / "scene.mcap"), "--repetitions", "1")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "scene.mcap").stat().st_size > 0
