"""A package that is not installed is named together with the extra that brings it."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from actum.installing import install_command
from actum.runtime import needs_extra
from actum.runtime.serving import INTERRUPTED, UNUSABLE
from actum_command.service_settings import DECLARED

PROJECT = Path(__file__).parents[2] / "pyproject.toml"

WITHOUT = """
import runpy, sys

class Uninstalled:
    def find_spec(name, *_):
        if name == sys.argv[2]:
            raise ModuleNotFoundError(name=name)

sys.meta_path.insert(0, Uninstalled)
runpy.run_module(sys.argv[1], run_name="__main__")
"""
"""Runs a service where a package is not installed."""


@pytest.mark.parametrize(
    ("service", "package", "extra"),
    [
        ("sensor_gateway", "cv2", "sensor-gateway"),
        ("scene_simulator", "cv2", "scene-simulator"),
        ("marker_tracker", "cv2", "marker-tracker"),
        ("ros2_bridge", "rosbags", "ros2"),
        ("actum_command", "typer", "actum-command"),
    ],
)
def test_a_service_without_its_extra_says_which_it_needs(service: str, package: str, extra: str) -> None:
    run = [sys.executable, "-c", WITHOUT, service, package]
    ended = subprocess.run(run, capture_output=True, text=True, check=False)
    assert ended.returncode == UNUSABLE
    assert ended.stderr == f"{package} is not installed: run {install_command(extra)}\n"


def test_each_service_can_be_installed_alone() -> None:
    extras = tomllib.loads(PROJECT.read_text())["project"]["optional-dependencies"]
    assert {service.replace("_", "-") for service in DECLARED} <= extras.keys()


def test_a_part_that_is_missing_of_what_is_installed_is_a_bug_and_crashes() -> None:
    with pytest.raises(ModuleNotFoundError), needs_extra("marker-tracker"):
        import actum.no_such_part  # noqa: F401


def test_an_interrupt_while_packages_are_imported_ends_a_process_without_a_traceback() -> None:
    with pytest.raises(SystemExit) as ended, needs_extra("marker-tracker"):
        raise KeyboardInterrupt
    assert ended.value.code == INTERRUPTED
