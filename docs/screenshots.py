"""Takes the page's pictures: of the simulated scene, by live processes, in Chromium.

    python -m docs.screenshots docs

The model is the marked demo's. `page.png` is light, `page-dark.png` dark, `page-phone.png` as wide as a phone.
"""

import shutil
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from playwright.sync_api import Browser, sync_playwright

from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.demo.marked import train_model
from actum_command.model_in_use import ModelInUse
from actum_command.service_settings import Given
from actum_command.supervising import Supervisor
from actum_model_trainer.progress import silent

WIDE: dict[str, Any] = {"viewport": {"width": 1440, "height": 1240}}
PHONE: dict[str, Any] = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "device_scale_factor": 2}
PICTURES: dict[str, dict[str, Any]] = {
    "page.png": WIDE | {"color_scheme": "light"},
    "page-dark.png": WIDE | {"color_scheme": "dark"},
    "page-phone.png": PHONE | {"color_scheme": "light"},
}
EVERYDAY: Given = {"everyday": ["all"], "pauses": ["short"]}
"""How the simulated person behaves: everyday doings come between the actions."""
PATIENCE_MS = 60_000
MOMENT_MS = 300
"""Until everything that belongs to an answer is drawn."""
ANSWERED = (
    "document.querySelector('#now .kicker').textContent.startsWith('Just now') && "
    "document.querySelector('#state').textContent === 'live'"
)
"""Whether the page shows a new answer, in JavaScript."""


def main(folder: Path) -> None:
    """Write the pictures to a folder."""
    with TemporaryDirectory() as scratch, sync_playwright() as playwright:
        model = Path(scratch) / "model.npz"
        train_model(Path(scratch) / "training.mcap", model, silent)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        with live_page(model, EVERYDAY, marked=True) as address:
            for name, options in PICTURES.items():
                take(browser, address, folder / name, options)
        browser.close()


@contextmanager
def live_page(model: Path, given: Given, marked: bool) -> Iterator[str]:
    """Run the whole system of the simulated scene, which marks its actions or does not; yield the page's address."""
    here = ServiceSettings(connect=f"tcp/127.0.0.1:{_free_port()}")
    with Supervisor(Path("/dev/null")) as supervisor:
        supervisor.start(processes.router(here))
        with Client(here, wait_s=30.0) as client:
            system = processes.system(here, "simulator", ModelInUse(model), given)
            system += [processes.scene(here)] if marked else []
            for program in processes.with_page(here, system, given):
                supervisor.start(program)
            while not (pages := [info.page for info in client.infos() if info.page]):
                time.sleep(0.1)
            yield pages[0]


def take(browser: Browser, address: str, file: Path, options: dict[str, Any]) -> None:
    """Wait for some answers, and take a picture right after one."""
    page = browser.new_context(**options).new_page()
    page.goto(address)
    page.wait_for_function("() => document.querySelectorAll('#timeline .segment').length > 3", timeout=PATIENCE_MS)
    while True:
        page.wait_for_function(f"() => !({ANSWERED})", timeout=PATIENCE_MS)
        page.wait_for_function(f"() => {ANSWERED}", timeout=PATIENCE_MS)
        page.wait_for_timeout(MOMENT_MS)
        page.screenshot(path=file)
        if page.evaluate(f"() => {ANSWERED}"):
            break
    page.context.close()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
