"""Measure all parts, or one, and write them as Markdown.

ACTUM_DATA=… python -m benchmarks.continuous [--only PART]
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from benchmarks.page import measure_sections, versions_of

from .bench import EVENTS, FALSE, HALF, LATENCY, POINTS, Bench, Goals, scores_table
from .cost import cost
from .early import early
from .familiarity import familiarity
from .idle import idle
from .methods import COST_OF_A_SECOND, INNER_FOLDS
from .never_trained import never_trained
from .scene import scene
from .sensitivity import sensitivity
from .strangers import strangers
from .streams import FOLDS, ContinuousSets, folds

PAGE = Path(__file__).with_name("results.md")
UTKINECT_GOALS: Goals = {
    "required": {EVENTS: "≥ 0.80", HALF: "≥ 0.70", FALSE: "≤ 2.00", LATENCY: "≤ 0.50"},
    "aimed at": {EVENTS: "≥ 0.90", HALF: "≥ 0.82", FALSE: "≤ 1.00", LATENCY: "≤ 0.30"},
}
COMPOSED_GOALS: Goals = {
    "required": {EVENTS: "≥ 0.94", HALF: "≥ 0.90", POINTS: "≥ 0.65"},
    "aimed at": {EVENTS: "≥ 0.97", HALF: "≥ 0.95", POINTS: "≥ 0.75"},
}
NATURAL_GOALS: Goals = {"required": {EVENTS: "≥ 0.90"}, "aimed at": {EVENTS: "≥ 0.94"}}


def utkinect(bench: Bench) -> Iterator[str]:
    """Ten actions in the order of a script, with walks and rests between them that nobody labelled."""
    yield "Ten people, twenty streams; what is between the actions is background, fifty walks among it."
    yield scores_table(bench.found(folds(bench.data.utkinect, bench.data.utkinect)), UTKINECT_GOALS)


def composed(bench: Bench) -> Iterator[str]:
    """Twelve gestures in mixed order."""
    yield """People with odd numbers, two streams of each: twice every gesture, in mixed order, as `actum import msrc12
--composed` makes them. What is trimmed off a gesture is background. An action point is claimed within the segment
found, at the fraction of its length at which those of the training people's lie, and is right within 333 ms."""
    yield scores_table(bench.found(folds(bench.data.composed, bench.data.composed)), COMPOSED_GOALS)


def natural(bench: Bench) -> Iterator[str]:
    """The set's own files, one gesture again and again, by the methods trained on composed streams."""
    yield """The first file of each gesture and person, as recorded, segments as `actum import msrc12 --trimmed` marks
them. Every method is the one that was trained on composed streams of other people."""
    yield scores_table(bench.found(folds(bench.data.composed, bench.data.natural)), NATURAL_GOALS)


PARTS: Mapping[str, tuple[str, Callable[[Bench], Iterator[str]]]] = {
    "utkinect": ("UTKinect-Action3D", utkinect),
    "sensitivity": ("As many false alarms as asked for", sensitivity),
    "composed": ("MSRC-12, composed streams", composed),
    "natural": ("MSRC-12, natural files", natural),
    "never-trained": ("Actions that were never trained", never_trained),
    "scene": ("The simulated scene, new people", scene),
    "idle": ("An hour without an action", idle),
    "strangers": ("Other people's movement", strangers),
    "familiarity": ("Familiarity of what is found", familiarity),
    "early": ("Partial answers", early),
    "cost": ("Four people at once", cost),
}


def header() -> Iterator[str]:
    """Say what was run, and by which protocol."""
    versions = versions_of("numpy", "aeon", "scikit-learn")
    yield "# Actions found without marks"
    yield f"""`make bench-continuous`: {versions}, one core. Whole recordings are
given without their marks. People are sorted, and fold f of {FOLDS} tests people f, f + {FOLDS}, … on what all others
taught; thresholds of the peers are chosen on training people alone, MiniRocket's on those left out in {INNER_FOLDS}
inner folds, by the mean of event F1 and F1 at IoU .5 less {COST_OF_A_SECOND} for each second of median latency. Ours
chooses its own in training."""
    yield """Events: the right label and a frame in common; F1@.5: an overlap (IoU) of at least .5. Each detection
claims the truth of its label that it overlaps most, and a truth takes the best claim; all others are false. False
detections are counted a minute of background, wherever they lie; in brackets those that lie in it. Latency is from the
true end to the decision. Recall at one false detection a minute: the best of all thresholds on familiarity, the peers'
on their confidence. Split: truths in several detections; merged: detections that hold several truths. The last
rows say what ours is required to show and what is aimed at; besides, it is to be above both peers, and at best within
three points of the bound."""


def main() -> None:
    measure_sections(PAGE, __doc__, header(), PARTS, lambda folder: Bench(ContinuousSets(folder)))


if __name__ == "__main__":
    main()
