"""Adding an action to a trained model beside training anew: each action is left out in turn and added back.

    python -m benchmarks.adding [msr|utkinect|simulated …]

Both models see the same samples: all of the other actions, and `EXAMPLES` of the action in question. The people who
train and those who test are different ones. Of MSR Action3D all are people on whom the presets' numbers were chosen.
Times are processor seconds of adding without the search for actions that nobody marked.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np
from benchmarks.originals import original

from actum_command.scene_marks import write_examples
from actum_dataset_importer.importing import import_msr_action3d, import_utkinect
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.sample_reading import samples_from, select
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.side_by_side import at_most
from actum_model_trainer.training import add_to, train
from som_classifier.model import Model
from som_classifier.presets import DEFAULT

EXAMPLES = 5
"""Examples of the action that is added, of as many people as possible."""


@dataclass(frozen=True)
class Set:
    """A set's recordings, who trains, and who tests."""

    write: Callable[[Path], object]
    training: tuple[str, ...]
    test: tuple[str, ...]


def silent(done: int, total: int) -> None:
    """Report nothing."""


def simulate(folder: Path) -> None:
    """Let four simulated people do each action six times."""
    folder.mkdir()
    for actor in range(4):
        write_examples(folder / f"{actor}.mcap", repetitions=6, actor=actor, seed=actor)


SETS = {
    "msr": Set(lambda out: import_msr_action3d(original("msr_action3d"), out, silent), ("1", "3", "5"), ("7", "9")),
    "utkinect": Set(lambda out: import_utkinect(original("utkinect"), out, silent), ("1", "2", "3", "5"), ("7", "9")),
    "simulated": Set(simulate, ("simulated 0", "simulated 1"), ("simulated 2", "simulated 3")),
}


def few_of(samples: Sequence[SegmentSample]) -> list[SegmentSample]:
    """Return `EXAMPLES` samples, one of each person after the other."""
    by_person: dict[str, list[SegmentSample]] = {}
    for sample in samples:
        by_person.setdefault(sample.person, []).append(sample)
    turns = zip_longest(*by_person.values())
    return [sample for turn in turns for sample in turn if sample is not None][:EXAMPLES]


@dataclass(frozen=True)
class Row:
    """What one action gives: both models' accuracy on all tests and on the action's own, and the time of adding.

    `unknown` and `unknown_others` are shares that the model with the added action calls unknown: of the tests of this
    action, and of the others.
    """

    anew: float
    added: float
    anew_own: float
    added_own: float
    unknown: float
    unknown_others: float
    adding_s: float


def rows(of: Set, samples: Sequence[SegmentSample]) -> Iterator[Row]:
    """Leave each action out in turn."""
    training = [sample for sample in samples if sample.person in of.training]
    test = [sample for sample in samples if sample.person in of.test]
    for label in sorted({sample.label for sample in samples}):
        others = [sample for sample in training if sample.label != label]
        new = few_of([sample for sample in training if sample.label == label])
        before, anew = train(others, DEFAULT), train([*others, *new], DEFAULT)
        began_s = time.process_time()
        added = add_to(before, before.kept, new, [])
        adding_s = time.process_time() - began_s
        own = np.array([sample.label == label for sample in test])
        right_anew, right = (right_of(model, test) for model in (anew, added))
        unknown = np.array([answer(added, encoded(added, sample)).unknown for sample in test])
        own_anew, own_added = right_anew[own].mean(), right[own].mean()
        called = float(unknown[own].mean()), float(unknown[~own].mean())
        yield Row(right_anew.mean(), right.mean(), own_anew, own_added, *called, adding_s)


def right_of(model: Model, test: Sequence[SegmentSample]) -> np.ndarray:
    """Return which samples a model names rightly."""
    return np.array([answer(model, encoded(model, sample)).label == sample.label for sample in test])


def main() -> None:
    """Measure the sets asked for, and print a table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.adding", description=__doc__)
    parser.add_argument("sets", nargs="*", default=list(SETS), metavar="SET")
    own = "own action: anew | added | called unknown"
    print(f"| set | anew | added | difference, points | {own} | others: called unknown | adding, s |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for name in parser.parse_args().sets:
        with tempfile.TemporaryDirectory() as folder, at_most(1):
            SETS[name].write(Path(folder) / name)
            found = list(rows(SETS[name], samples_from(select([Path(folder)])).usable))
        print(line(name, found), flush=True)


def line(name: str, found: Sequence[Row]) -> str:
    """Write a set's means over the actions, and the mean difference with its standard error."""
    differences = 100 * np.array([row.added - row.anew for row in found])
    error = differences.std(ddof=1) / np.sqrt(len(found))
    fields = ("anew", "added", "anew_own", "added_own", "unknown", "unknown_others")
    anew, added, *others = (f"{100 * np.mean([getattr(row, field) for row in found]):.1f}" for field in fields)
    seconds = f"{np.mean([row.adding_s for row in found]):.2f}"
    return f"| {' | '.join([name, anew, added, f'{differences.mean():+.1f} ± {error:.1f}', *others, seconds])} |"


if __name__ == "__main__":
    main()
