"""The sets that the recogniser is developed on, each with people to learn from and people to answer."""

from collections.abc import Sequence
from dataclasses import dataclass

from .datasets import Datasets, Example
from .splits import DRAWS, Split, folds_of_people, halves, leave_one_person_out
from .videos import why_no_camera

MSRC12_FOLDS = 5
VIDEOS = "Florence, camera"


@dataclass(frozen=True)
class DevelopmentSet:
    """One set.

    Attributes:
        protocol: how it is split, in words.
        of_few: sequences to learn few examples from, where there are more than `examples`; else the same.
    """

    name: str
    protocol: str
    examples: Sequence[Example]
    of_few: Sequence[Example]
    splits: Sequence[Split]


def development_sets(data: Datasets) -> list[DevelopmentSet]:
    """Return the sets; without the videos where there is no pose model to see them with."""
    sets = [
        _of("MSR Action3D", f"{DRAWS} draws of five and five people", data.msr, list(halves(data.msr))),
        _one_out("UTKinect", data.utkinect),
        *([_one_out(VIDEOS, data.florence)] if why_no_camera() is None else []),
    ]
    folds = list(folds_of_people(data.msrc12, MSRC12_FOLDS))
    protocol = f"people with odd numbers in {MSRC12_FOLDS} folds of {len({e.person for e in folds[0].test})}"
    return [*sets, DevelopmentSet("MSRC-12", protocol, data.msrc12, data.msrc12_of_few, folds)]


def said_of_videos() -> str:
    """Say why the videos are left out; nothing where they are not."""
    reason = why_no_camera()
    return "" if reason is None else f" {VIDEOS}, was left out: {reason}."


def _one_out(name: str, examples: Sequence[Example]) -> DevelopmentSet:
    return _of(name, "one person left out in turn", examples, list(leave_one_person_out(examples)))


def _of(name: str, protocol: str, examples: Sequence[Example], splits: Sequence[Split]) -> DevelopmentSet:
    return DevelopmentSet(name, protocol, examples, examples, splits)
