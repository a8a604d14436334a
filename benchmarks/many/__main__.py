"""Measure all parts, or one, and write them as Markdown.

python -m benchmarks.many [--only PART]
"""

import os
import platform
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

from benchmarks.page import measure_page, part_asked_for

from actum_command.simulated_model import SIMULATED_MODEL

from .crowds import crowds
from .takeover import takeover

PAGE = Path(__file__).with_name("results.md")
PARTS: Mapping[str, tuple[str, Callable[[Path], Iterator[str]]]] = {
    "crowds": ("Crowds before five sensors", crowds),
    "takeover": ("Classifiers that are killed", takeover),
}


def header() -> Iterator[str]:
    """Say what was run."""
    yield "# Many sensors"
    yield (
        f"`make bench-many`: Python {platform.python_version()}, {os.cpu_count()} processors. The model is the one of "
        "the simulated scene that comes with actum. The program that puts the frames and receives the answers runs on "
        "the same machine."
    )


def section(folder: Path, part: str) -> str:
    """Measure one part."""
    title, measure = PARTS[part]
    model = folder / f"{part}.npz"
    shutil.copy(SIMULATED_MODEL, model)
    return "\n\n".join([f"## {title}", *measure(model)])


def main() -> None:
    only = part_asked_for("benchmarks.many", __doc__, PARTS)
    with tempfile.TemporaryDirectory() as folder:
        measure_page(PAGE, only, header(), PARTS, partial(section, Path(folder)))


if __name__ == "__main__":
    main()
