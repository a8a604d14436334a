"""How often the answer to a whole sequence is right, by five protocols."""

from collections.abc import Iterator, Sequence

import numpy as np

from actum_dataset_importer.msr_action3d import CLASSES

from .bench import RECOGNISERS, Bench
from .peers import MINIROCKET, MULTIROCKET, Recogniser
from .scores import Difference, Score, mean_sd, percent, table
from .splits import DRAWS, Split, halves, leave_one_person_out, odd_even, same_people

COUNTED = ("recogniser", "accuracy %", "right", "95 % interval")
AUTHORS = frozenset(CLASSES[:9]) | {CLASSES[16]}


def cross_subject(bench: Bench) -> Iterator[str]:
    """All twenty actions, odd people trained, even people tested."""
    split = odd_even(bench.data.msr)
    yield f"""MSR Action3D, the usual 557 sequences of 20 actions. Trained: people {split.people} ({len(split.training)}
sequences). Tested: people 2, 4, 6, 8, 10 ({len(split.test)})."""
    yield table(COUNTED, ([recogniser.name, *bench.score(recogniser, split).cells] for recogniser in RECOGNISERS))


def action_sets(bench: Bench) -> Iterator[str]:
    """The three subsets that much of the literature reports."""
    splits = [odd_even(bench.data.action_set(number)) for number in (1, 2, 3)]
    yield f"""The subsets AS1, AS2 and AS3 of eight actions each, odd people trained, even people tested
({", ".join(f"{len(split.training)} and {len(split.test)}" for split in splits)} sequences)."""
    yield table(("recogniser", "AS1", "AS2", "AS3", "average %"), (_sets_row(bench, r, splits) for r in RECOGNISERS))


def random_halves(bench: Bench) -> Iterator[str]:
    """Ten draws of the people to train."""
    splits = list(halves(bench.data.msr))
    shares = {r.name: np.array([bench.score(r, split).share for split in splits]) for r in RECOGNISERS}
    ratio = float(np.mean([len(split.test) / len(split.training) for split in splits]))
    yield f"""The 557 sequences; {DRAWS} draws of five people to train, the other five tested. People 1, 3, 5, 7 and 9,
on whom the preset was chosen, appear among those tested here. Differences are paired by draw, in points ± standard
error; in brackets the standard error corrected for draws that share people (Nadeau and Bengio, 2003)."""
    header = ("recogniser", "mean %", "s.d.", "minus MiniRocket", "minus MultiRocket")
    yield table(header, (_halves_row(name, shares, ratio) for name in shares))
    yield table(
        ("trained", *shares),
        ([split.people, *(percent(own[i]) for own in shares.values())] for i, split in enumerate(splits)),
    )


def utkinect(bench: Bench) -> Iterator[str]:
    """Each person tested by what learnt from the others."""
    splits = list(leave_one_person_out(bench.data.utkinect))
    yield f"""UTKinect-Action3D, {len(bench.data.utkinect)} labelled segments of 10 actions, cut as the label file says.
Each of {len(splits)} people tested on what was trained on the others; answers pooled."""
    yield table(COUNTED, ([r.name, *pooled(bench, r, splits).cells] for r in RECOGNISERS))


def authors(bench: Bench) -> Iterator[str]:
    """The paper's own kind of split."""
    splits = list(same_people([example for example in bench.data.msr if example.label in AUTHORS]))
    yield f"""The ten actions a01–a09 and a17 of MSR Action3D, a random quarter of the sequences tested
({len(splits[0].training)} and {len(splits[0].test)}), the same people in both; {DRAWS} draws. The paper's authors
report 83 % for an earlier version of their system on 276 sequences of these actions and samples not trained on."""
    rows = ([r.name, *mean_sd([bench.score(r, split).share for split in splits])] for r in RECOGNISERS)
    yield table(("recogniser", "mean %", "s.d."), rows)


def pooled(bench: Bench, recogniser: Recogniser, splits: Sequence[Split], share: float = 1.0) -> Score:
    """Add up the counts of all splits."""
    return sum((bench.score(recogniser, split, share) for split in splits), Score(0, 0))


def _sets_row(bench: Bench, recogniser: Recogniser, splits: Sequence[Split]) -> list[str]:
    scores = [bench.score(recogniser, split) for split in splits]
    cells = (f"{share} ({count}; {interval})" for share, count, interval in (score.cells for score in scores))
    return [recogniser.name, *cells, percent(float(np.mean([score.share for score in scores])))]


def _halves_row(name: str, shares: dict[str, np.ndarray], ratio: float) -> list[str]:
    cells = []
    for other in (MINIROCKET.name, MULTIROCKET.name):
        gap = Difference(100 * (shares[name] - shares[other]))
        errors = f"± {gap.standard_error:.1f} ({gap.corrected_error(ratio):.1f})"
        cells.append("" if name == other else f"{gap.mean:+.1f} {errors}")
    return [name, *mean_sd(shares[name].tolist()), *cells]
