"""Teaching on the page of live processes: by whoever stands before the camera, and from video clips."""

import re
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from live import System, free_endpoint, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.system, pytest.mark.long]
Open = Callable[..., Any]
SIMULATED = ("scene_simulator", "--driven", "--image-hz", "0")
ACTIONS = ("lift", "push", "put")
SHORT = 8
"""Characters of a model's id that the page shows."""
QUIET_S = 180.0
"""How long teaching three actions may take on a machine that does nothing else; here it is told only."""
PATIENCE_MS = 240_000
DONE_MS = 90_000
"""The simulated person takes half a minute for five repetitions."""
CLIPS = {"wave": 1, "clap": 4, "bow": 9}
"""Actions of the recorded clips, and their numbers in the files' names."""


def start(running: System, open_page: Open, *sensor: str) -> Any:
    """Start everything without a model; return the page, open where people teach."""
    model, port = str(running.folder / "in-use.npz"), free_endpoint().rpartition(":")[2]
    running.start_router()
    for name in ("pose_preprocessor", "action_fusion", "marker_tracker"):
        running.start(name)
    running.start("som_classifier", "--model", model)
    running.start("model_trainer", "--model", model)
    if sensor:
        running.start(*sensor)
    running.start("web_dashboard", "--page-port", port)
    with running.client() as client:
        running.wait_for_services(client, "som_classifier", "model_trainer", "web_dashboard")
        wait_until(lambda: any(info.page for info in client.infos()), "the page is served")
    page = open_page(f"http://127.0.0.1:{port}/")
    page.set_default_timeout(PATIENCE_MS)
    page.get_by_role("link", name="Teach").click()
    press(page, "Create set")
    wait_for(page, "created.")
    return page


def press(page: Any, name: str, within: Any = None) -> None:
    (within or page).get_by_role("button", name=name, exact=True).locator("visible=true").click()


def record(page: Any, label: str, times: int = 5) -> None:
    """Record an action that the simulated person does."""
    action = page.get_by_role("combobox", name="Action").locator("visible=true")
    action.fill(label)
    page.get_by_role("combobox", name="Person").fill("anna")
    action.press("Enter")
    recorded = page.get_by_text(f"{times} of {label} recorded")
    press(page, "Have the simulated person do it")
    recorded.wait_for(timeout=DONE_MS)
    wait_for(page.get_by_role("region", name=f"Examples of {label}"), f"{times} examples")


def wait_for(within: Any, text: str) -> None:
    within.get_by_text(text).first.wait_for()


def train_and_use(page: Any) -> str:
    """Train, put the model into use, wait until the classifier has it; return its short name."""
    page.get_by_role("link", name="Models").click()
    press(page, "Train")
    press(page, "Use this model")
    told = page.locator("#training").get_by_text(re.compile("^model [0-9a-f]+: ")).text_content()
    model = str(told).split()[1].rstrip(":")[:SHORT]
    page.get_by_role("row", name=model).get_by_text("in use").wait_for()
    return model


def classifier_has(running: System, model: str) -> None:
    with running.client() as client:

        def models() -> list[str]:
            return [info.model or "" for info in client.infos() if info.service == "som_classifier"]

        wait_until(lambda: any(each.startswith(model) for each in models()), f"the classifier uses {model}")


def recognised(running: System, page: Any, actions: tuple[str, ...]) -> None:
    """Have the simulated person do actions without marks; wait until the page tells that it found each."""
    page.get_by_role("link", name="Live").click()
    with running.client() as client:
        client.ask("sensor_gateway", "perform", actions=list(actions), object_id=1, pause_s=2.5)
    for action in actions:
        page.get_by_role("button", name=re.compile(rf"^{action}\b.*, found$")).first.wait_for()


@pytest.mark.timeout(1500)
def test_three_actions_are_taught_by_clicks_and_keys_and_recognised_without_marks(
    running: System, open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    began_s = time.monotonic()
    page = start(running, open_page, *SIMULATED)
    page.locator("#state").get_by_text("The classifier has no model").wait_for()
    for action in ACTIONS:
        record(page, action)
    first = train_and_use(page)
    classifier_has(running, first)
    recognised(running, page, ACTIONS)
    with capsys.disabled():
        print(f"\n  taught and recognised in {time.monotonic() - began_s:.0f} s; {QUIET_S:.0f} s on a quiet machine")

    page.get_by_role("link", name="Teach").click()
    press(page, "Redo the last take")
    press(page, "Have the simulated person do it")
    wait_for(page, "5 of put recorded")
    wait_for(page.get_by_role("region", name="Examples of put"), "5 examples")
    press(page, "Delete all examples of push")
    press(page, "Delete all", page.get_by_role("dialog"))
    page.get_by_role("region", name="Examples of push").wait_for(state="detached")
    second = train_and_use(page)
    assert second != first
    press(page, "Back to the previous model")
    page.get_by_role("row", name=first).get_by_text("in use").wait_for()
    classifier_has(running, first)


@pytest.mark.timeout(1500)
@pytest.mark.data
@pytest.mark.pose_model
def test_clips_dropped_on_the_page_teach_and_one_that_is_none_is_refused(
    running: System, data: Path, tmp_path: Path, open_page: Open
) -> None:
    page = start(running, open_page)
    page.get_by_role("spinbutton", name="How many times").fill("1")
    files = page.get_by_label("Drop a video anywhere")
    no_video = tmp_path / "wave 0.mp4"
    no_video.write_bytes(b"<html>no video</html>")
    files.set_input_files(no_video)
    wait_for(page.locator("#video"), "Failed: ")
    for person in (1, 2):
        page.get_by_role("combobox", name="Person").fill(f"person {person}")
        files.set_input_files([clip(data, tmp_path, label, person) for label in CLIPS])
        for label in CLIPS:
            group = page.get_by_role("region", name=f"Examples of {label}")
            wait_for(group, f"{person} example")
    page.get_by_role("img", name="Film of bow 2", exact=True).wait_for()
    classifier_has(running, train_and_use(page))


def clip(data: Path, folder: Path, label: str, person: int) -> Path:
    """Copy a recorded clip to a file that is called as what is done in it."""
    found = sorted((data / "florence3d_rgb").glob(f"*actor{person}id*category{CLIPS[label]}.mp4"))[0]
    return Path(shutil.copy(found, folder / f"{label} {person}.mp4"))


@pytest.mark.timeout(300)
def test_the_take_that_is_recorded_outlives_a_page_that_is_loaded_anew(running: System, open_page: Open) -> None:
    page = start(running, open_page, *SIMULATED)
    press(page, "Record background")
    page.reload()
    press(page, "Stop")
    wait_for(page.locator("#set"), "s of background")
    with running.client() as client:
        (only,) = client.ask("model_trainer", "list")["sets"]
    assert [take["kind"] for take in only["takes"]] == ["background"]
