"""Teaches three simulated actions on the page while two busy loops take the cores: does every take end by itself?

python -m benchmarks.teaching_on_page [RUNS]: prints a line for each take and each run; ends with code 1 where one is
not right.
"""

import multiprocessing
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Page, sync_playwright
from playwright.sync_api import TimeoutError as TookTooLong

from actum.messages import Info
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.model_in_use import ModelInUse, taught_model
from actum_command.service_settings import Given
from actum_command.supervising import Supervisor
from scene_simulator.programme import ACTIONS

ENDPOINT = "tcp/127.0.0.1:7459"
EACH = 3
"""Actions that are taught in a run: the scene's five in turn."""
TIMES = 5
RUNS = 10
LOOPS = 2
DONE_MS = 90_000
"""Until a take that has not ended by itself is stopped: the simulated person needs 22 s."""
PATIENCE_MS = 120_000
"""Until the page shows something, on a busy machine."""


def main() -> None:
    """Teach so many times, and print what came of it."""
    runs, right = int(sys.argv[1]) if sys.argv[1:] else RUNS, 0
    with sync_playwright() as playwright, busy_loops():
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--disable-gpu"])
        for run in range(1, runs + 1):
            with live() as (client, address):
                page = browser.new_context().new_page()
                page.set_default_timeout(PATIENCE_MS)
                page.goto(f"{address}#teach")
                began_s = time.monotonic()
                press(page, "Create set")
                page.get_by_text("created.").locator("visible=true").wait_for()
                chosen = [ACTIONS[(EACH * (run - 1) + number) % len(ACTIONS)] for number in range(EACH)]
                taken = [taught(page, client, action) for action in chosen]
                right += all(taken)
                print(f"run {run}: {sum(taken)} of {len(taken)} right, {time.monotonic() - began_s:.0f} s", flush=True)
                page.context.close()
    print(f"{right} of {runs} runs right")
    raise SystemExit(right < runs)


def taught(page: Page, client: Client, label: str) -> bool:
    """Record one action by one press; print and return whether the take ended by itself with what was asked for."""
    began_s = time.monotonic()
    action = page.get_by_role("combobox", name="Action").locator("visible=true")
    action.fill(label)
    page.get_by_role("combobox", name="Person").fill("anna")
    action.press("Enter")
    press(page, "Have the simulated person do it")
    began = page.get_by_role("button", name="Discard", exact=True)
    began.wait_for()
    try:
        began.wait_for(state="hidden", timeout=DONE_MS)
        ended = True
    except TookTooLong:
        press(page, "Stop")
        ended = False
    seconds = time.monotonic() - began_s
    stored = client.ask("model_trainer", "list")["sets"][0]["actions"].get(label, 0)
    said = page.locator("#record .left > .outcome").text_content()
    print(
        f"  {label}: {TIMES} asked, {stored} stored, {'ended' if ended else 'stopped'}, {seconds:.0f} s: {said}",
        flush=True,
    )
    return ended and stored == TIMES


def press(page: Page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).locator("visible=true").click()


@contextmanager
def live() -> Iterator[tuple[Client, str]]:
    """Run the whole system of the simulated scene without a model; yield a client of it and the page's address."""
    settings = ServiceSettings(connect=ENDPOINT)
    with TemporaryDirectory() as folder, Supervisor(Path(folder) / "log") as supervisor:
        given: Given = {"driven": True, "segments": ["auto"], "trainer_data": [folder]}
        supervisor.start(processes.router(settings))
        with Client(settings, wait_s=60.0) as client:
            system = processes.system(settings, "simulator", ModelInUse(taught_model(given)), given)
            supervisor.start(*processes.with_page(settings, system))
            infos: dict[str, Info] = {}
            while not {"web_dashboard", "model_trainer"} <= infos.keys():
                time.sleep(0.1)
                infos = {info.service: info for info in client.infos()}
            yield client, infos["web_dashboard"].page or ""


@contextmanager
def busy_loops() -> Iterator[None]:
    """Keep the cores busy beside."""
    loops = [multiprocessing.get_context("spawn").Process(target=spin, daemon=True) for _ in range(LOOPS)]
    for loop in loops:
        loop.start()
    try:
        yield
    finally:
        for loop in loops:
            loop.terminate()


def spin() -> None:
    """Do nothing, as fast as it goes."""
    while True:
        pass


if __name__ == "__main__":
    main()
