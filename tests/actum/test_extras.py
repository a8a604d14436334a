"""A package that is not installed is named together with the extra that brings it."""

import subprocess
import sys

import pytest

from actum.runtime import needs_extra
from actum.runtime.serving import UNUSABLE


@pytest.mark.parametrize(
    ("service", "package", "extra"),
    [
        ("sensor_gateway", "cv2", "sensor-gateway"),
        ("scene_simulator", "cv2", "scene-simulator"),
        ("marker_tracker", "cv2", "marker-tracker"),
        ("actum_command", "typer", "actum-command"),
    ],
)
def test_a_service_without_its_extra_says_which_it_needs(service: str, package: str, extra: str) -> None:
    without = f"import runpy, sys; sys.modules['{package}'] = None; runpy.run_module('{service}', run_name='__main__')"
    ended = subprocess.run([sys.executable, "-c", without], capture_output=True, text=True, check=False)
    assert ended.returncode == UNUSABLE
    assert ended.stderr == f"{package} is not installed: pip install 'actum[{extra}]'\n"


def test_a_part_that_is_missing_of_what_is_installed_is_a_bug_and_crashes() -> None:
    with pytest.raises(ModuleNotFoundError), needs_extra("marker-tracker"):
        import actum.no_such_part  # noqa: F401
