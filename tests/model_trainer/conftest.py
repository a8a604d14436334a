import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from teaching import Teacher

MadeOnce = Callable[[str, Callable[[Path], None]], Path]


@pytest.fixture(scope="session")
def made_once(tmp_path_factory: pytest.TempPathFactory) -> MadeOnce:
    """Make a folder, unless another worker has made the one of that name."""
    mine = tmp_path_factory.getbasetemp()
    shared = mine.parent if "PYTEST_XDIST_WORKER" in os.environ else mine

    def made(name: str, make: Callable[[Path], None]) -> Path:
        if not (shared / name).exists():
            make(new := tmp_path_factory.mktemp(name))
            with suppress(OSError):  # another worker was faster
                new.rename(shared / name)
        return shared / name

    return made


@pytest.fixture
def teacher(taught: Path, tmp_path: Path) -> Teacher:
    """Somebody who teaches in a copy of what a module's tests were taught."""
    shutil.copytree(taught, tmp_path / "copy")
    return Teacher(tmp_path / "copy")
