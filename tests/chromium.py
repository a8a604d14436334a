"""Whether a page can be opened here, and by what."""

import shutil
from importlib.util import find_spec

NAMES = ("chromium", "chromium-browser", "google-chrome")
NEEDS_PLAYWRIGHT = "Playwright is not installed: pip install playwright axe-playwright-python"
NEEDS_CHROMIUM = "no Chromium is installed: apt install chromium"


def path() -> str | None:
    """Find Chromium."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def missing() -> str | None:
    """Say why no page can be opened here, if so."""
    if find_spec("playwright") is None or find_spec("axe_playwright_python") is None:
        return NEEDS_PLAYWRIGHT
    return None if path() else NEEDS_CHROMIUM
