"""Measure all parts, or one, and write them as Markdown; draw the figures when all are measured.

python -m benchmarks.paper [--only PART]
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from benchmarks.page import measure_sections, versions_of

from .data import Data
from .details import details
from .figures import figures
from .protocols import protocols
from .scene import scene
from .steps import steps

PAGE = Path(__file__).with_name("results.md")
PARTS: Mapping[str, tuple[str, Callable[[Data], Iterator[str]]]] = {
    "protocols": ("The protocols", protocols),
    "scene": ("Table 2 of the paper", scene),
    "steps": ("What each step is worth", steps),
    "details": ("What cannot be as printed", details),
    "figures": ("The figures", figures),
}


def header() -> Iterator[str]:
    """Say what was run, and how it was chosen."""
    versions = versions_of("numpy", "opencv-python-headless")
    yield "# The paper's recogniser"
    yield f"""`make bench-paper`: {versions}; one core."""
    yield """The preset `paper` is the architecture of Gharaee, Gärdenfors and Johnsson (2017), as
[docs/paper.md](../../docs/paper.md) goes through it. What the paper leaves open was chosen by cross-validation on
people 1, 3, 5, 7 and 9 of MSR Action3D (each left out; a random quarter of their share of the author's set), on
UTKinect and on simulated actors 0 and 20 to 22. That axes, centres of activity and the first map's last radius matter
was seen first on other draws of the author's set and on all people of MSR Action3D, so that these are not unseen."""


def main() -> None:
    measure_sections(PAGE, __doc__, header(), PARTS, Data)


if __name__ == "__main__":
    main()
