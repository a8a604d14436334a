"""How early contacts of hands with objects are foreseen, beside what is simpler; written as Markdown.

python -m benchmarks.intent [DIR] [--only PART]

DIR is the folder of the OptiTrack takes; without it that part is left out.
"""

import argparse
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from benchmarks.intent import boxes, habits, pairs
from benchmarks.intent.learning import (
    CAPTURED_WEIGHT,
    EVERYDAY_WEIGHT,
    PERSONS,
    SEED,
    Examples,
    background_takes,
    learnt,
)
from benchmarks.intent.takes import LAYOUTS, bare, captured, everyday, simulated, without_body
from benchmarks.page import measure_page

from action_fusion.intent.contact_network import shipped_network
from actum_model_trainer.foreseeing.baselines import compared
from actum_model_trainer.foreseeing.said import said_by
from actum_model_trainer.foreseeing.scoring import (
    ALARM,
    BEFORE_S,
    HORIZON_S,
    LATE_S,
    PRECISION,
    Said,
    Scores,
    calibration_error,
    false_alarms_per_min,
)
from actum_model_trainer.foreseeing.takes import Take

PAGE = Path(__file__).with_name("results.md")
TESTED, TEST_SEED = range(121, 129), 5
"""Simulated people from whom nothing was learnt, nor chosen."""
WATCHED, WATCHED_MIN = range(131, 141), 3.0
"""Those who do everyday things, and for how long each (minutes)."""
HABITUAL = range(141, 157)
"""Those of the habits: more, so that errors are not those of single people."""
FOLDS = 5
"""Parts of the motion capture, of which each is left out of the learning in turn."""
FOLD_PERSONS, FOLD_STEPS = range(1, 9), 2000
"""Simulated people learnt from beside motion capture, and steps of learning: fewer, since it is learnt five times."""
HEAD = (
    "| | time ahead, median (s) | precision | announced ahead | right "
    + " | right ".join(f"{s} s before" for s in BEFORE_S)
    + " | Brier 0.5 s before | time error 0.5 s before (s) |\n|---|---:|---:|---:|"
    + "---:|" * (len(BEFORE_S) + 2)
)


def table(ours: Sequence[Said], training: Sequence[Take]) -> str:
    """Return a table of ours and the baselines on the same takes."""
    return "\n".join([HEAD, *(_row(name, scores) for name, scores in compared(ours, training).items())])


def _row(name: str, scores: Scores) -> str:
    best, half = scores.ahead, scores.at_half
    cells = [name, f"{best.median_s:.2f}", f"{best.precision:.2f}", f"{best.recall:.2f}"]
    cells += [f"{each.right:.2f}" for each in scores.before]
    cells += [f"{half.brier:.2f}", f"{half.time_error_s:.2f}"] if scores.is_probable else ["", ""]
    return f"| {' | '.join(cells)} |"


def of_simulated(_folder: Path | None) -> Iterator[str]:
    """Yield the tables of simulated people."""
    network, training = shipped_network(), simulated(FOLD_PERSONS, SEED)
    said = [said_by(network, take) for take in simulated(TESTED, TEST_SEED)]
    yield (
        f"{len(TESTED)} people from whom nothing was learnt, {len(LAYOUTS)} takes each, joints with the noise of a "
        f"Kinect; {sum(len(each.take.contacts) for each in said)} contacts."
    )
    for count in sorted({objects for objects, _ in LAYOUTS}):
        yield f"### {count} objects"
        yield table([each for each in said if len(each.take.objects_m) == count], training)
    yield f"Expected calibration error of the object's probability, all takes: {calibration_error(said):.3f}."


def of_captured(folder: Path | None) -> Iterator[str]:
    """Yield the table of motion capture, takes left out in turn."""
    if folder is None:
        yield "Not run: the folder was not given."
        return
    takes, said = captured(folder), []
    acting = [*map(without_body, simulated(FOLD_PERSONS, SEED)), *bare(FOLD_PERSONS, SEED)]
    background = map(without_body, background_takes()[::3])
    usual = Examples.joined([Examples.of(acting), Examples.of(background, EVERYDAY_WEIGHT)])
    of_takes = [Examples.of([take], CAPTURED_WEIGHT) for take in takes]
    for fold in range(FOLDS):
        rest = [each for number, each in enumerate(of_takes) if number % FOLDS != fold]
        network = learnt(usual, rest, steps=FOLD_STEPS)
        said += [said_by(network, take) for take in takes[fold::FOLDS]]
    yield (
        f"{len(takes)} takes of one person, hands and three objects; each fifth is left out of the learning in turn. "
        f"{sum(len(each.take.contacts) for each in said)} contacts: first motions after a labelled approach, or its "
        "end, and in a lift without one. The nearest training path is one of simulated people."
    )
    yield table(said, acting)
    yield f"Expected calibration error: {calibration_error(said):.3f}."


def of_everyday(_folder: Path | None) -> Iterator[str]:
    """Yield how often a contact is announced that does not come."""
    said = [said_by(shipped_network(), take) for take in everyday(WATCHED, TEST_SEED, WATCHED_MIN)]
    minutes = sum(each.take.minutes for each in said)
    acting = [said_by(shipped_network(), take) for take in simulated(TESTED, TEST_SEED)]
    among_five = [said_by(shipped_network(), take) for take in everyday(WATCHED, TEST_SEED, WATCHED_MIN, LAYOUTS[4])]
    yield (
        f"{minutes:.0f} minutes of {len(WATCHED)} people who do everyday things at the table, with three actions each. "
        f"False alarms (probability of {ALARM} or more, and no contact with that object within {HORIZON_S} s): "
        f"**{false_alarms_per_min(said):.2f} a minute**. Calibration error: {calibration_error(said):.3f}; "
        "together with the simulated people above, who do one action after the other, "
        f"{calibration_error([*said, *acting]):.3f}. The same people among five objects: "
        f"{false_alarms_per_min(among_five):.2f} a minute, calibration error {calibration_error(among_five):.3f}."
    )


def of_pairs(_folder: Path | None) -> Iterator[str]:
    """Yield how rightly action and object are said together, through the services' steps."""
    yield from pairs.table(TESTED, TEST_SEED)


def of_habits(_folder: Path | None) -> Iterator[str]:
    """Yield what the objects of earlier actions add."""
    yield from habits.table(HABITUAL, TEST_SEED)


def of_cad120(folder: Path | None) -> Iterator[str]:
    """Yield the table of reaches whose objects are known by their boxes alone."""
    near = None if folder is None else folder.with_name("cad120")
    yield from ["Not run: there is no such folder."] if near is None or not near.is_dir() else boxes.table(near)


def of_cost(_folder: Path | None) -> Iterator[str]:
    """Yield what a posture costs with eight objects."""
    network, [take] = shipped_network(), everyday(WATCHED[:1], TEST_SEED, 1.0)
    eight = {number: take.objects_m[1 + number % 3] + 0.1 * number for number in range(8)}
    busy = Take(take.name, take.stamps_ns, take.arms_m, eight, [])
    began_s = time.process_time()
    said_by(network, busy)
    each_s = (time.process_time() - began_s) / len(busy.stamps_ns)
    yield (
        f"{1e3 * each_s:.2f} ms of a core for a posture with eight objects; four people at 30 frames/s take "
        f"{100 * 4 * 30 * each_s:.0f} % of a core."
    )


PARTS: Mapping[str, tuple[str, Callable[[Path | None], Iterator[str]]]] = {
    "simulated": ("Simulated people", of_simulated),
    "captured": ("Motion capture", of_captured),
    "everyday": ("Everyday things", of_everyday),
    "cad120": ("Reaches among boxes", of_cad120),
    "pairs": ("Action and object together", of_pairs),
    "habits": ("What each action was done to before", of_habits),
    "cost": ("Cost", of_cost),
}


def header() -> Iterator[str]:
    """Say what is measured."""
    yield "# Contacts foreseen"
    yield (
        "`make bench-intent`: which object a hand will touch, and when. A contact is the object's first motion (5 mm); "
        "of one that does not move, the end of the labelled approach or of the reach with which somebody points at it. "
        "What is said counts from the frame in which it is computed. *Time ahead*: how long before each contact its "
        "object's `soon_probability` reaches a threshold, the earliest one at which "
        f"{PRECISION:.0%} of the announcements are right; a contact that is not announced counts as 0. An announcement "
        f"is right if its object is touched within {HORIZON_S} s, or was {LATE_S} s before; one that goes on for "
        "longer counts anew. *Right*: the share of contacts whose likeliest object was the right one so long before. "
        f"*Brier*: of all objects, each touched within {HORIZON_S} s or not. "
        f"The network was learnt from other simulated people ({len(PERSONS)}) and, as it comes with actum, from the "
        "motion capture."
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="benchmarks.intent", description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", metavar="DIR")
    parser.add_argument("--only", choices=PARTS, metavar="PART")
    given = parser.parse_args()
    data = os.environ.get("ACTUM_DATA")
    folder = given.folder or (Path(data) / "bimacs_optitrack" if data else None)
    measure_page(PAGE, given.only, header(), PARTS, partial(section, folder))


def section(folder: Path | None, part: str) -> str:
    """Measure one part."""
    title, measure = PARTS[part]
    return "\n\n".join([f"## {title}", *measure(folder)])


if __name__ == "__main__":
    main()
