"""Films how three actions are taught on the page: a few seconds of an animated picture, APNG.

    python -m docs.teaching_film docs/teaching.png

The simulated person does what is recorded. Waiting is left out, so that it goes faster than it went.
"""

import shutil
import sys
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from docs.screenshots import live_page
from PIL import Image
from playwright.sync_api import Page, sync_playwright
from playwright.sync_api import TimeoutError as TookTooLong

VIEW: dict[str, Any] = {"viewport": {"width": 1120, "height": 784}, "color_scheme": "light", "device_scale_factor": 1}
SIZE = (800, 560)
"""Pixels: as wide as a README is shown."""
COLOURS = 64
"""One palette for all pictures: with one each, nothing could be left out of the next."""
ACTIONS = ("lift", "push", "put")
TIMES = 5
PATIENCE_MS = 180_000
DONE_MS = 60_000
"""The simulated person takes half a minute for five repetitions."""
LOADED_MS = 2500
"""Until the classifier has a model that was put into use."""
DO_IT = "Have the simulated person do it"
TYPED_MS, COUNTED_MS, PLAYED_MS, HELD_MS = 110, 170, 130, 1100
"""How long a picture stands (ms): while somebody types, counts, looks at films, and at the end of a scene."""


class Film:
    """Pictures of a page, and how long each is shown."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.pictures: list[Image.Image] = []
        self.durations_ms: list[int] = []

    def receive(self, stands_ms: int) -> None:
        """Add a picture."""
        seen = Image.open(BytesIO(self.page.screenshot())).convert("RGB")
        self.pictures.append(seen.resize(SIZE, Image.Resampling.LANCZOS))
        self.durations_ms.append(stands_ms)

    def while_waiting(self, text: str, stands_ms: int, every_ms: int) -> None:
        """Add pictures until a text is seen."""
        awaited = self.page.get_by_text(text).locator("visible=true").first
        while not awaited.is_visible():
            self.receive(stands_ms)
            self.page.wait_for_timeout(every_ms)

    def save(self, file: Path) -> None:
        """Write the film, in colours that suit all its pictures."""
        whole = Image.new("RGB", (SIZE[0], SIZE[1] * len(self.pictures[::8])))
        for number, picture in enumerate(self.pictures[::8]):
            whole.paste(picture, (0, number * SIZE[1]))
        palette = whole.quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
        first, *others = (picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in self.pictures)
        first.save(
            file, format="PNG", save_all=True, append_images=others, duration=self.durations_ms, loop=0, optimize=True
        )


def main(file: Path) -> None:
    """Teach, and write the film."""
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        given = {"driven": True, "segments": ["auto"], "trainer_data": [folder]}
        with live_page(Path(folder) / "model.npz", given, marked=False) as address:
            page = browser.new_context(**VIEW).new_page()
            page.set_default_timeout(PATIENCE_MS)
            page.goto(f"{address}#teach")
            film = Film(page)
            teach(film)
            train(film)
            recognise(film)
        browser.close()
    film.save(file)


def teach(film: Film) -> None:
    """Record three actions: the first is filmed, then the examples of all."""
    page = film.page
    press(page, "Create set")
    page.get_by_text("created.").locator("visible=true").wait_for()
    page.get_by_role("combobox", name="Person").fill("anna")
    for letters in range(len(ACTIONS[0]) + 1):
        action(page).fill(ACTIONS[0][:letters])
        film.receive(TYPED_MS)
    record(page)
    film.while_waiting(f"{TIMES} of {ACTIONS[0]} recorded", COUNTED_MS, 700)
    for label in ACTIONS[1:]:
        action(page).fill(label)
        record(page)
        recorded = page.get_by_text(f"{TIMES} of {label} recorded")
        try:
            recorded.wait_for(timeout=DONE_MS)
        except TookTooLong:
            press(page, DO_IT)  # once more: one was not counted
            recorded.wait_for()
    page.get_by_role("img", name=f"Film of {ACTIONS[-1]} {TIMES}").wait_for()
    page.locator("#examples").scroll_into_view_if_needed()
    page.evaluate("() => scrollTo(0, document.querySelector('#examples').offsetTop - 70)")
    page.wait_for_timeout(1000)
    for _ in range(14):
        film.receive(PLAYED_MS)


def train(film: Film) -> None:
    """Train a model and put it into use."""
    page = film.page
    page.get_by_role("link", name="Models").click()
    press(page, "Train")
    page.locator("#training .stage").wait_for()
    for _ in range(4):
        film.receive(2 * COUNTED_MS)
        page.wait_for_timeout(1500)
    press(page, "Use this model")
    page.get_by_role("row").filter(has_text="in use").wait_for()
    film.receive(HELD_MS)


def recognise(film: Film) -> None:
    """Have two actions done without marks, and show that they are recognised."""
    page = film.page
    page.wait_for_timeout(LOADED_MS)
    page.evaluate(PERFORM, {"actions": list(ACTIONS[:2]), "object_id": 1, "pause_s": 2.5})
    page.get_by_role("link", name="Live").click()
    page.locator("#actions .key", has_text=ACTIONS[-1]).wait_for()
    for label in ACTIONS[:2]:
        answered = page.get_by_role("button", name=f"{label} ").first
        while not answered.is_visible():
            film.receive(COUNTED_MS)
            page.wait_for_timeout(300)
        film.receive(HELD_MS)


PERFORM = """async (fields) => {
  const { link } = await import("/page/link.js");
  await link.ask("sensor_gateway", "perform", fields);
}"""
"""Asks the simulated person as any program may, in JavaScript."""


def record(page: Page) -> None:
    """Begin a take, which the simulated person fills."""
    action(page).press("Enter")
    press(page, DO_IT)


def action(page: Page) -> Any:
    """Find the field of what is done."""
    return page.get_by_role("combobox", name="Action").locator("visible=true")


def press(page: Page, name: str) -> None:
    """Press a button."""
    page.get_by_role("button", name=name, exact=True).locator("visible=true").click()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
