"""Measure all parts, or one, and write them as Markdown.

ACTUM_DATA=… python -m benchmarks.continuation [--only PART]
"""

import platform
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from importlib.metadata import version
from pathlib import Path

from benchmarks.page import measure_page, part_asked_for

from .tables import Bench, cost, measured, smoothed

PAGE = Path(__file__).with_name("results.md")
PARTS: Mapping[str, tuple[str, Callable[[Bench], Iterator[str]]]] = {
    "measured": ("Postures as measured", measured),
    "smoothed": ("Postures as smoothed", smoothed),
    "cost": ("Cost", cost),
}


def header() -> Iterator[str]:
    """Say what was run, and how it was chosen."""
    yield "# How postures go on"
    yield f"""`make bench-continuation`: Python {platform.python_version()}, numpy {version("numpy")}, one core. From
every fifth of a second of a recording the posture is predicted 0.25, 0.5 and 1 s ahead: by the continuation of a model
that `actum train --continue` makes, and by three assumptions: the posture stays as it was measured; it stays as the
classifier smooths it; it goes on from there at the velocity that the classifier estimates."""
    yield """Models are trained on every second person of a set, beginning with the first, and tested on the others; in
the simulated scene on people 0 to 8, and on people 20 to 28, who do more kinds of things besides. Penalty, weight of
activity, learning rates and presentations were compared on the training people alone, two thirds of them against one
third; in a range of a factor of ten they hardly matter. The form of both methods was found earlier in folds over all
people: displacements instead of postures are read off the map, the step is 0.25 s, and the activity one step before
is a second input. Penalty and weight of activity were first looked at there, too. For these choices the tested people
are not unseen."""


def section(bench: Bench, part: str) -> str:
    """Measure one part."""
    title, measure = PARTS[part]
    return "\n\n".join([f"## {title}", *measure(bench)])


def main() -> None:
    only = part_asked_for("benchmarks.continuation", __doc__, PARTS)
    with tempfile.TemporaryDirectory() as folder:
        measure_page(PAGE, only, header(), PARTS, partial(section, Bench(Path(folder))))


if __name__ == "__main__":
    main()
