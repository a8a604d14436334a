"""Pages in Chromium, of a service that is given what a live system would put."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

import chromium as installed
from dashboards import Colleague, served
from page_scenes import Scene, maps

Open = Callable[..., Any]
WITHOUT_3D = ["--disable-software-rasterizer", "--disable-gpu"]
BUGS = ("Content Security", "a bug in the page")
"""What the console says where the page is wrong."""
PATIENCE_MS = 60_000
"""Where a browser draws in software, beside other tests."""


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


@pytest.fixture
def open_page(chromium: Any) -> Iterator[Open]:
    """Open an address in a browser of its own; what goes wrong in the page fails the test."""
    with opener(chromium) as opened:
        yield opened


@pytest.fixture
def open_in_3d(chromium_3d: Any) -> Iterator[Open]:
    """The same in one that draws 3-D."""
    with opener(chromium_3d) as opened:
        yield opened


@contextmanager
def opener(browser: Any) -> Iterator[Open]:
    contexts, errors = [], []

    def opened(address: str, **options: Any) -> Any:
        contexts.append(browser.new_context(**options))
        page = contexts[-1].new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: errors.append(said.text) if any(bug in said.text for bug in BUGS) else None)
        page.goto(address)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert errors == []


@pytest.fixture
def scene() -> Iterator[Scene]:
    with served(Colleague(maps)) as page, Scene(page) as made:
        yield made
