"""What all tests share: where the recordings are, and one line when they are not there."""

import gc
import os
import subprocess
import sys
from collections.abc import Iterator
from ctypes.util import find_library
from importlib.util import find_spec
from itertools import accumulate, groupby
from operator import itemgetter
from pathlib import Path

import pytest
from hypothesis import settings

import chromium

settings.register_profile("patient", deadline=None, max_examples=30)
settings.register_profile("ci", settings.get_profile("patient"), derandomize=True, max_examples=50)
settings.load_profile("ci" if os.environ.get("CI") else "patient")

ROOT = Path(__file__).parents[1]
COLLECT = [sys.executable, "-m", "pytest", "--collect-only", "-q"]
OBJECTS_TO_COLLECT = 20_000
"""New objects after which garbage is looked for: after Python's 700, that takes a twentieth of the tests' CPU."""
NEEDS_DATA = "recordings not found: set ACTUM_DATA to the folder that holds msr_action3d/ and utkinect/"


NEEDS_MODEL = "pose model not found: set ACTUM_POSE_MODEL to the file that `actum models fetch` gets"
NEEDS_LIBRARIES = "MediaPipe is linked against libEGL and libGLESv2: apt install libegl1 libgles2"
NEEDS_ROS2_EXTRA = "the bridge to ROS 2 is written with rosbags: pip install -e '.[ros2]'"
NEEDS_CAMERA_EXTRA = "MediaPipe is not installed: pip install -e '.[camera]'"
SKIPPED = (
    ("on real recordings", NEEDS_DATA),
    ("with the pose model", NEEDS_MODEL),
    ("with the pose model", NEEDS_CAMERA_EXTRA),
    ("with the pose model", NEEDS_LIBRARIES),
    ("of the bridge to ROS 2", NEEDS_ROS2_EXTRA),
    ("with librealsense", "the source realsense needs pyrealsense2"),
    ("of the page in a browser", chromium.NEEDS_PLAYWRIGHT),
    ("of the page in a browser", chromium.NEEDS_CHROMIUM),
    ("with Rerun", "rerun-sdk is not installed: pip install -e '.[view]'"),
    ("with Foxglove", "is not installed: pip install -e '.[dev]'"),
    ("with OpenNI 2", "the source openni2 needs OpenNI 2"),
    ("of hosts' clocks", "wall clocks are set apart by"),
)


def pose_model_missing() -> str | None:
    """Say why no pose can be found here, if so."""
    if not Path(os.environ.get("ACTUM_POSE_MODEL") or "nowhere").is_file():
        return NEEDS_MODEL
    if find_spec("mediapipe") is None:
        return NEEDS_CAMERA_EXTRA
    linked = sys.platform != "linux" or (find_library("EGL") and find_library("GLESv2"))
    return None if linked else NEEDS_LIBRARIES


def data_folder() -> Path | None:
    folder = os.environ.get("ACTUM_DATA")
    return Path(folder) if folder and Path(folder).is_dir() else None


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile tests before several workers would, each for itself."""
    if session.config.getoption("numprocesses", None) and not tests_are_compiled():
        subprocess.run(COLLECT, cwd=ROOT, stdout=subprocess.DEVNULL, check=False)


def tests_are_compiled() -> bool:
    """Say whether tests were collected here before, or cannot be stored compiled."""
    return sys.dont_write_bytecode or (ROOT / "tests" / "actum" / "__pycache__").is_dir()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Keep the garbage collector away from the thousands of tests, none of which is ever garbage."""
    gc.disable()
    collected = yield
    gc.freeze()
    gc.set_threshold(OBJECTS_TO_COLLECT)
    gc.enable()
    return collected


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    chosen = config.getoption("-m") or ""
    for marker in ("live", "containers", "long", "chaos", "browser", "thorough"):
        if marker not in chosen:
            skipped = [item for item in items if item.get_closest_marker(marker)]
            if skipped:
                config.hook.pytest_deselected(items=skipped)
                items[:] = [item for item in items if item not in skipped]
    items[:] = spread(items)
    if data_folder() is None:
        for item in items:
            if item.get_closest_marker("data"):
                item.add_marker(pytest.mark.skip(reason=NEEDS_DATA))
    for marker, missing in (("pose_model", pose_model_missing()), ("browser", chromium.missing())):
        for item in items if missing else ():
            if item.get_closest_marker(marker):
                item.add_marker(pytest.mark.skip(reason=missing))


def spread(items: list[pytest.Item]) -> list[pytest.Item]:
    """Spread modules that wait for processes evenly among those that compute: each worker gets an equal share."""
    modules = [list(tests) for _, tests in groupby(items, key=lambda item: item.path)]
    placed = []
    for waits in (True, False):
        alike = [tests for tests in modules if (tests[0].get_closest_marker("system") is not None) is waits]
        ends = list(accumulate(map(len, alike)))
        placed += [(end / ends[-1], tests) for end, tests in zip(ends, alike, strict=True)]
    return [test for _, tests in sorted(placed, key=itemgetter(0)) for test in tests]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    for what, reason in SKIPPED:
        without = [r for r in terminalreporter.stats.get("skipped", []) if reason in str(r.longrepr)]
        if without:
            terminalreporter.write_line(f"{len(without)} tests {what} skipped: {reason}")


@pytest.fixture(scope="session")
def pose_model() -> Path:
    return Path(os.environ["ACTUM_POSE_MODEL"])


@pytest.fixture(scope="session")
def data() -> Path:
    folder = data_folder()
    assert folder is not None, NEEDS_DATA
    return folder
