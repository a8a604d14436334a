"""Measure all parts, or one, and write them as Markdown.

ACTUM_DATA=… python -m benchmarks.continuation [--only PART]
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from benchmarks.page import measure_sections, versions_of

from .tables import Bench, cost, measured, smoothed

PAGE = Path(__file__).with_name("results.md")
PARTS: Mapping[str, tuple[str, Callable[[Bench], Iterator[str]]]] = {
    "measured": ("Postures as measured", measured),
    "smoothed": ("Postures as smoothed", smoothed),
    "cost": ("Cost", cost),
}


def header() -> Iterator[str]:
    """Say what was run, and how it was chosen."""
    versions = versions_of("numpy")
    yield "# How postures go on"
    yield f"""`make bench-continuation`: {versions}, one core. From
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


def main() -> None:
    measure_sections(PAGE, __doc__, header(), PARTS, Bench)


if __name__ == "__main__":
    main()
