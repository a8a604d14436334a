import shutil
from pathlib import Path

import pytest

from teaching import Teacher


@pytest.fixture
def teacher(taught: Path, tmp_path: Path) -> Teacher:
    """Somebody who teaches in a copy of what a module's tests were taught."""
    shutil.copytree(taught, tmp_path / "copy")
    return Teacher(tmp_path / "copy")
