"""The README's programs, verbatim, with nothing of ours installed."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Event, Skeleton
from live import System, collect, wait_until

ROOT = Path(__file__).parents[2]
pytestmark = [pytest.mark.system]


def example(name: str) -> str:
    """Cut a named program out of the README."""
    match = re.search(
        rf"<!-- example: {re.escape(name)} -->\n```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S
    )
    assert match, name
    return match[1]


@pytest.fixture(scope="module")
def plain_python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment that holds eclipse-zenoh and msgpack only."""
    folder = tmp_path_factory.mktemp("plain")
    python = folder / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "--no-compile", "eclipse-zenoh>=1.10,<2", "msgpack"], check=True)
    return python


@pytest.fixture
def scene(running: System, scene_model: Path) -> System:
    running.start_router()
    for name in ("pose_preprocessor", "marker_tracker", "action_fusion"):
        running.start(name)
    running.start("som_classifier", "--model", str(scene_model))
    return running


def test_one_reads_events_and_the_other_marks_them(scene: System, plain_python: Path, tmp_path: Path) -> None:
    for name in ("events.py", "marks.py"):
        (tmp_path / name).write_text(example(name))
    printed = tmp_path / "printed.txt"
    with scene.client() as client, printed.open("w") as output:
        scene.wait_for_services(client, "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion")
        reader = subprocess.Popen([plain_python, tmp_path / "events.py"], env=scene.environment, stdout=output)
        marker = subprocess.Popen(
            [plain_python, tmp_path / "marks.py", "my-first"],
            env=scene.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
        )
        try:
            assert marker.stdin is not None
            skeletons = client.listen(keys.pattern(keys.SKELETON, client.sensor))
            events = client.listen(keys.pattern(keys.EVENT, client.sensor))
            scene.start("scene_simulator")
            collect(skeletons, Skeleton, lambda found: len(found) >= 35)
            marker.stdin.write(b"\n")
            marker.stdin.flush()
            collect(skeletons, Skeleton, lambda found: len(found) >= 50)
            marker.stdin.write(b"\n")
            marker.stdin.flush()
            [event] = collect(events, Event, bool)
            assert marker.wait(timeout=10) == 0
            assert (event.segment_id, event.valid, event.reason) == ("my-first", True, None)
            assert event.objects_present == [1, 2, 3]
            wait_until(lambda: event.sentence in printed.read_text(), "the reader prints the event")
        finally:
            reader.kill()
            reader.wait()
            marker.kill()
            marker.wait()
            marker.stdin.close()


def test_marking_without_a_classifier_fails_and_says_so(running: System, plain_python: Path, tmp_path: Path) -> None:
    (tmp_path / "marks.py").write_text(example("marks.py"))
    running.start_router()
    with running.client():
        marking = subprocess.run(
            [plain_python, tmp_path / "marks.py", "a"],
            check=False,
            env=running.environment,
            capture_output=True,
            text=True,
            timeout=20,
        )
    assert marking.returncode == 1
    assert "nobody listens" in marking.stderr


def test_the_programs_are_as_short_as_they_claim() -> None:
    assert len(example("events.py").splitlines()) <= 10
