"""Pages in Chromium, of a service that is given what a live system would put."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import chromium as installed
from dashboards import Colleague, served
from lessons import Lesson, lesson
from live import System, system
from page_scenes import Scene, maps

Open = Callable[..., Any]
WITHOUT_3D = ["--disable-software-rasterizer", "--disable-gpu"]
BUGS = ("Content Security", "a bug in the page")
"""What the console says where the page is wrong."""
PATIENCE_MS = 60_000
"""Where a browser draws in software, beside other tests."""
SMALL = {"viewport": {"width": 960, "height": 600}}
"""Where 3-D is drawn in software, by the pixel."""
STILL = {"reduced_motion": "reduce"}
"""Films of examples play only where a test has them play: drawn in software, they take half a core."""


@pytest.fixture
def running(tmp_path: Path) -> Iterator[System]:
    with system(tmp_path) as made:
        yield made


@pytest.fixture(scope="session")
def playwright() -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        yield started


@pytest.fixture(scope="session")
def chromium(playwright: Any) -> Iterator[Any]:
    """A browser that draws no 3-D, which in software takes a core."""
    browser = playwright.chromium.launch(executable_path=installed.path(), args=WITHOUT_3D)
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def chromium_3d(playwright: Any) -> Iterator[Any]:
    browser = playwright.chromium.launch(executable_path=installed.path())
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def context(chromium: Any) -> Iterator[Any]:
    """What pages share that need nothing of their own: a context that is new costs as much as a page to load."""
    with chromium.new_context(**STILL) as made:
        yield made


@pytest.fixture(scope="session")
def context_3d(chromium_3d: Any) -> Iterator[Any]:
    with chromium_3d.new_context(**STILL, **SMALL) as made:
        yield made


@pytest.fixture
def open_page(context: Any) -> Iterator[Open]:
    """Open an address, in a context of its own where it has options; what goes wrong in the page fails the test."""
    with opener(context) as opened:
        yield opened


@pytest.fixture
def open_in_3d(context_3d: Any) -> Iterator[Open]:
    """The same in a browser that draws 3-D."""
    with opener(context_3d) as opened:
        yield opened


@contextmanager
def opener(shared: Any) -> Iterator[Open]:
    own, errors = [], []

    def opened(address: str, **options: Any) -> Any:
        if options:
            own.append(shared.browser.new_context(**STILL | options))
        page = (own[-1] if options else shared).new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: errors.append(said.text) if any(bug in said.text for bug in BUGS) else None)
        page.goto(address)
        return page

    yield opened
    for opened_one in (*own, *shared.pages):
        opened_one.close()
    shared.set_offline(False)
    assert errors == []


@pytest.fixture(autouse=True)
def described_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("web_dashboard.application.DESCRIBING_S", 0.2)


@pytest.fixture
def room(taught: Path, tmp_path: Path) -> Iterator[Lesson]:
    """A lesson in a copy of the folder that the module has taught."""
    shutil.copytree(taught, tmp_path / "copy")
    with lesson(tmp_path / "copy") as made:
        yield made


@pytest.fixture
def scene() -> Iterator[Scene]:
    with served(Colleague(maps)) as page, Scene(page) as made:
        yield made
