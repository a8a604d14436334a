"""Behind routers that hold everybody to a role, doctor tells what is hidden from what is not there."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from actum.mcap_file import RecordingError
from actum.messages import Event
from actum.recording import Recording
from deployments import Deployed, deployed
from events import event
from live import PATIENCE_S, wait_until

pytestmark = pytest.mark.system


@pytest.fixture(scope="module")
def deployment(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Deployed]:
    with deployed(tmp_path_factory.mktemp("deployment")) as made:
        yield made


def said(deployment: Deployed, identity: str) -> str:
    doctor = deployment.actum(identity, "compute", "doctor")
    assert doctor.process.wait(timeout=PATIENCE_S) == 1
    return " ".join(doctor.said().split())


def test_who_may_look_is_told_that_nothing_runs(deployment: Deployed) -> None:
    found = said(deployment, "viewer")
    assert "pose_preprocessor is not running: start it" in found
    assert "access control" not in found


def test_who_may_not_look_is_told_that(deployment: Deployed) -> None:
    preprocessor = deployment.start("pose_preprocessor", "compute")
    with deployment.client("viewer", "compute") as client:
        wait_until(lambda: len(client.infos()) == 1, "it runs")
        found = said(deployment, "gateway.kinect0")
    preprocessor.terminate()
    assert found.startswith("services run, but the router's access control denies this program permission")
    assert "such as viewer" in found


def test_a_viewer_may_keep_events(deployment: Deployed, tmp_path: Path) -> None:
    history = deployment.actum("viewer", "compute", "record", str(tmp_path), "--events")
    with deployment.client("fusion.kinect0", "compute") as client:
        client.put(event("s1", "push object 1, the cup"))
        wait_until(lambda: any(stored(tmp_path)), "it is stored")
    history.terminate()
    assert history.process.returncode == 0
    assert [message.segment_id for message in stored(tmp_path) if isinstance(message, Event)] == ["s1"]


def stored(folder: Path) -> list[object]:
    found: list[object] = []
    for file in sorted(folder.glob("*.mcap*")):
        with suppress(RecordingError):  # a file that has just been opened holds nothing yet
            found += Recording(file).messages()
    return found
