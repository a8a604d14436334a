"""What all tests share: where the recordings are, and one line when they are not there."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")

NEEDS_DATA = "recordings not found: set ACTUM_DATA to the folder that holds msr_action3d/ and utkinect/"


def data_folder() -> Path | None:
    folder = os.environ.get("ACTUM_DATA")
    return Path(folder) if folder and Path(folder).is_dir() else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    chosen = config.getoption("-m") or ""
    for marker in ("live", "containers"):
        if marker not in chosen:
            skipped = [item for item in items if item.get_closest_marker(marker)]
            if skipped:
                config.hook.pytest_deselected(items=skipped)
                items[:] = [item for item in items if item not in skipped]
    if data_folder() is None:
        for item in items:
            if item.get_closest_marker("data"):
                item.add_marker(pytest.mark.skip(reason=NEEDS_DATA))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    without = [r for r in terminalreporter.stats.get("skipped", []) if NEEDS_DATA in str(r.longrepr)]
    if without:
        terminalreporter.write_line(f"{len(without)} tests on real recordings skipped: {NEEDS_DATA}")


@pytest.fixture(scope="session")
def data() -> Path:
    folder = data_folder()
    assert folder is not None, NEEDS_DATA
    return folder
