"""Makes the picture of Rerun's viewer: a recording of the simulated scene with images, as `actum view --web` shows it.

    python -m docs.viewer_picture docs/viewer.png

Needs the extra `view`, Playwright and a Chromium. The page calls no host but this machine: others are refused.
"""

import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import urlsplit

from benchmarks.rig.chain import Chain
from docs.picture import model
from PIL import Image
from playwright.sync_api import Route, sync_playwright

from actum.messages import Truth
from actum.recorder import Recorder
from actum_command.scene_marks import mark_of
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator
from som_classifier.model import Model

SEED, START_NS = 2, 1_700_000_000_000_000_000
FRAMES = 240
"""Eight seconds: three actions and a part of the fourth."""
SIZE_PX = {"width": 1280, "height": 800}
PORT, WEB_PORT = 19876, 19090
DRAWN_MS = 25_000
"""How long Chromium may take to draw all of it without a graphics card (ms)."""
COLOURS = 160
"""A palette of so many keeps the picture below 200 kB."""


def record(output: Path, recogniser: Model, frames: int = FRAMES) -> None:
    """Record a scene with images, marks, and what the nodes say of it."""
    chain = Chain(recogniser)
    simulator = Simulator(balanced_programme(2, SEED), 0, SEED, image_hz=15, start_ns=START_NS)
    with Recorder(output, person="simulated 0", source="simulator") as recorder:
        for _, messages in zip(range(frames), simulator.frames(), strict=False):
            for message in messages:
                for output_message in chain.feed(mark_of(message) if isinstance(message, Truth) else message):
                    recorder.write(output_message)


def photograph(recording: Path, picture: Path) -> None:
    """Show a recording by the command, and write what the page looks like."""
    ports = ("--port", str(PORT), "--web-port", str(WEB_PORT))
    command = (sys.executable, "-m", "actum_command", "view", "--web", *ports, str(recording))
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewer, sync_playwright() as playwright:
        assert viewer.stdout is not None
        address = next(word for line in viewer.stdout for word in line.split() if word.startswith("http"))
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        page = browser.new_page(viewport=SIZE_PX)
        page.route("**/*", _refuse_elsewhere)
        page.goto(f"{address.rstrip(';')}&renderer=webgl&hide_welcome_screen=1")
        page.wait_for_timeout(DRAWN_MS)
        page.screenshot(path=picture)
        browser.close()
        viewer.terminate()
    Image.open(picture).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(picture, optimize=True)


def _refuse_elsewhere(route: Route) -> None:
    if (urlsplit(route.request.url).hostname or "").startswith("127."):
        route.continue_()
    else:
        route.abort()


def main() -> None:
    """Write the picture."""
    with TemporaryDirectory() as folder:
        record(Path(folder) / "scene.mcap", model())
        photograph(Path(folder) / "scene.mcap", Path(sys.argv[1]))


if __name__ == "__main__":
    main()
