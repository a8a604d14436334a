"""`make install` says what went wrong where something did, and nothing of it where nothing did."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PIP = """#!/bin/sh
case "$*" in *camera*) exit {code};; esac
"""


def installed(folder: Path, camera_code: int) -> subprocess.CompletedProcess[str]:
    """Install with a pip that does nothing, and ends so where the camera is asked for."""
    (folder / "bin").mkdir()
    pip = folder / "bin" / "pip"
    pip.write_text(PIP.format(code=camera_code))
    pip.chmod(0o755)
    command = ["make", "--always-make", "install", f"VENV={folder}", "PYTHON=true"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)


def test_an_installation_that_succeeds_complains_of_nothing(tmp_path: Path) -> None:
    done = installed(tmp_path, camera_code=0)
    assert "actum needs Python" not in done.stdout + done.stderr
    assert "cannot be installed" not in done.stdout + done.stderr
    assert "takes a minute" in done.stdout


@pytest.mark.parametrize("code", [1, 2])
def test_an_installation_without_mediapipe_says_so_and_goes_on(tmp_path: Path, code: int) -> None:
    done = installed(tmp_path, camera_code=code)
    assert "MediaPipe cannot be installed here" in done.stderr
    assert "MediaPipe cannot be installed here" not in done.stdout
    assert (tmp_path / ".installed").exists()
