"""Measure all parts, or one, and write them as Markdown; draw the figures when all are measured.

python -m benchmarks.paper [--only PART]
"""

import platform
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from importlib.metadata import version
from pathlib import Path

from benchmarks.page import measure_page, part_asked_for

from .data import Data
from .details import details
from .figures import figures
from .protocols import protocols
from .scene import scene
from .steps import steps

PAGE = Path(__file__).with_name("results.md")
LIBRARIES = ("numpy", "opencv-python-headless")
PARTS: Mapping[str, tuple[str, Callable[[Data], Iterator[str]]]] = {
    "protocols": ("The protocols", protocols),
    "scene": ("Table 2 of the paper", scene),
    "steps": ("What each step is worth", steps),
    "details": ("What cannot be as printed", details),
    "figures": ("The figures", figures),
}


def header() -> Iterator[str]:
    """Say what was run, and how it was chosen."""
    versions = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    yield "# The paper's recogniser"
    yield f"""`make bench-paper`: Python {platform.python_version()}, {versions}; one core."""
    yield """The preset `paper` is the architecture of Gharaee, Gärdenfors and Johnsson (2017), as
[docs/paper.md](../../docs/paper.md) goes through it. What the paper leaves open was chosen by cross-validation on
people 1, 3, 5, 7 and 9 of MSR Action3D (each left out; a random quarter of their share of the author's set), on
UTKinect and on simulated actors 0 and 20 to 22. That axes, centres of activity and the first map's last radius matter
was seen first on other draws of the author's set and on all people of MSR Action3D, so that these are not unseen."""


def section(data: Data, part: str) -> str:
    """Measure one part."""
    title, measure = PARTS[part]
    return "\n\n".join([f"## {title}", *measure(data)])


def main() -> None:
    only = part_asked_for("benchmarks.paper", __doc__, PARTS)
    with tempfile.TemporaryDirectory() as folder:
        measure_page(PAGE, only, header(), PARTS, partial(section, Data(Path(folder))))


if __name__ == "__main__":
    main()
