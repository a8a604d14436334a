"""What is measured: actions on objects, pointing from afar, and actions in empty space."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain, count

import numpy as np
from benchmarks.rig.hard_scenes.conditions import Conditions, load_conditions
from benchmarks.rig.hard_scenes.pantomime import Pantomime

from actum.node import SECOND_NS
from scene_simulator.programme import Task

from .observing import MEASURES, Scene
from .rest_to_rest import WAYS, Way, trials_from_rest_to_rest
from .trials import OURS, Trial, share

CONTACT = ("push", "pull", "put", "lift")
IDS = (1, 2, 3)
SPACINGS_M = (0.10, 0.20, 0.30)
POINTING_SPACING_M = 0.20
POINTING_DISTANCES_M = (1.0, 1.25, 1.5, 1.75, 2.0)
EMPTY_M = (0.15, 0.20, 0.37)
TOUCHING_M = 0.12
"""The palm of a hand that grasps is a decimetre from an object's middle: a pantomime so near all but touches it."""

EMPTY_SPACINGS_M = (0.10, 0.20)
EMPTY_CONDITIONS = ("plain", "together")
IMAGE_HZ = 15
STILL_IMAGE_HZ = 2
"""Nothing moves that is pointed at."""

RETURNING_CONDITIONS = ("plain", "together")

FIRST_PERSON, FIRST_IN_CONTACT, FIRST_RETURNING = 1001, 2001, 3001
CONTACT_PEOPLE, POINTING_PEOPLE, EMPTY_PEOPLE, RETURNING_PEOPLE = 6, 40, 3, 3

QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Of the errors of bounds: from the earliest to the latest."""

Table = Callable[[], Iterator[str]]


def contact(name: str) -> Iterator[str]:
    """Let everybody do the four actions, each on another object."""
    yield from _contact_table(
        {f"{100 * spacing_m:.0f} cm apart": _contacts(name, spacing_m) for spacing_m in SPACINGS_M}
    )


def contact_in_all_conditions() -> Iterator[str]:
    """Put together what was done to the objects in all conditions."""
    named = {name: [_contacts(name, spacing_m) for spacing_m in SPACINGS_M] for name in load_conditions()}
    yield from _contact_table({name: list(chain(*of_condition)) for name, of_condition in named.items()})


def pointing() -> Iterator[str]:
    """Let everybody point at each object, from several distances."""
    yield "| | object | the true line from eye to fingertip |"
    yield "|---|---|---|"
    rows = {f"from {distance_m:g} m": _pointings(distance_m) for distance_m in POINTING_DISTANCES_M}
    for what, trials in {**rows, "**all**": [t for of in rows.values() for t in of]}.items():
        yield f"| {what} | {share(trials, lambda t: t.object_right(OURS))} | {share(trials, lambda t: t.line_right)} |"


def pantomimes() -> Iterator[str]:
    """Let everybody do the four actions beside the objects."""
    yield "| the palm at its nearest to an object's middle | no object: proximity | no object: joint |"
    yield "|---|---|---|"
    rows = {_nearness(empty_m): _pantomimes(empty_m) for empty_m in EMPTY_M}
    everything = [t for of in rows.values() for t in of]
    rows |= {action: [t for t in everything if t.truth.action == action] for action in CONTACT}
    rows |= {"**all**": everything, f"not among them: {_nearness(TOUCHING_M)}": _pantomimes(TOUCHING_M)}
    for what, trials in rows.items():
        shares = [share(trials, lambda t, m=measure: t.object_right(m)) for measure in MEASURES]
        yield f"| {what} | {' | '.join(shares)} |"


def rest_to_rest() -> Iterator[str]:
    """Let everybody do the actions, and come to rest again before the segment ends."""
    yield """The segment begins 0.2 s before the hand leaves its rest and ends 0.2 s after it is back. Meanwhile the
object is left there, goes back by itself as where actions are taught in the simulated scene, or is taken back by the
hand on the same way. True is what the action did, which for things that are pointed at is nothing."""
    yield ""
    yield "| | object | displacement | with direction | outcome |"
    yield "|---|---|---|---|---|"
    ways = {way: [t for name in RETURNING_CONDITIONS for t in _returnings(name, way)] for way in WAYS}
    conditions = {name: [t for way in WAYS for t in _returnings(name, way)] for name in RETURNING_CONDITIONS}
    everything = list(chain(*ways.values()))
    actions = {action: [t for t in everything if t.truth.action == action] for action in (*CONTACT, "point")}
    for what, trials in {**ways, **conditions, **actions, "**all**": everything}.items():
        rights = (_object_right, Trial.displacement_right, Trial.direction_right, Trial.outcome_right)
        yield f"| {what} | {' | '.join(share(trials, right) for right in rights)} |"


def unmarked() -> Iterator[str]:
    """Put beside each other what is told of all these actions with marks and without."""
    yield """Fusion is told what the classifier finds by itself. *Alarms* are events that tell of no action. *Lost* are
objects that are right where the action is marked and not where it is found, and what would have mended each: the true
start, the true end, either, or only both; *action* where it is the name of the action that is wrong."""
    yield ""
    yield "| | object, marked | found | named rightly | object, of those found | lost | alarms |"
    yield "|---|---|---|---|---|---|---|"
    contacts = {name: [t for spacing_m in SPACINGS_M for t in _contacts(name, spacing_m)] for name in load_conditions()}
    everything = list(chain(*contacts.values()))
    actions = {action: [t for t in everything if t.truth.action == action] for action in CONTACT}
    pointed = list(chain(*map(_pointings, POINTING_DISTANCES_M)))
    empty = list(chain(*map(_pantomimes, EMPTY_M)))
    rows = {**contacts, **actions, "**all of these**": everything, "**pointing**": pointed, "**pantomimes**": empty}
    for what, trials in rows.items():
        yield _unmarked_row(what, trials)
    yield ""
    yield from _offsets([*everything, *pointed, *empty])


PARTS: Mapping[str, tuple[str, Table]] = {
    **{name: (f"Push, pull, put, lift: {name}", lambda name=name: contact(name)) for name in load_conditions()},
    "contact": ("Push, pull, put, lift: all conditions", contact_in_all_conditions),
    "pointing": ("Pointing, objects 20 cm apart", pointing),
    "pantomimes": ("Pantomimes: push, pull, put, lift where nothing is", pantomimes),
    "rest_to_rest": ("From rest to rest: the hand is back before the segment ends", rest_to_rest),
    "unmarked": ("The same actions, found without marks", unmarked),
}


def _contact_table(rows: Mapping[str, list[Trial]]) -> Iterator[str]:
    everything = list(chain(*rows.values()))
    more = {action: [t for t in everything if t.truth.action == action] for action in CONTACT}
    more["seen where it ends"] = [t for t in everything if t.seen_left]
    more["not seen where it ends"] = [t for t in everything if not t.seen_left]
    yield "| | object: proximity | object: joint | displacement | with direction | outcome |"
    yield "|---|---|---|---|---|---|"
    for what, trials in {**rows, **more, "**all**": everything}.items():
        yield _contact_row(what, trials)


def _contact_row(what: str, trials: Sequence[Trial]) -> str:
    objects = [share(trials, lambda t, m=measure: t.object_right(m)) for measure in MEASURES]
    became = [share(trials, right) for right in (Trial.displacement_right, Trial.direction_right, Trial.outcome_right)]
    return f"| {what} | {' | '.join([*objects, *became])} |"


def _unmarked_row(what: str, trials: Sequence[Trial]) -> str:
    found = [t for t in trials if t.found]
    lost = Counter(t.lost_by for t in trials if t.lost_by)
    cells = [
        share(trials, lambda t: t.object_right(OURS)),
        share(trials, lambda t: t.found),
        share(found, lambda t: t.named),
        share(found, lambda t: t.unmarked_right),
        ", ".join(f"{number} {why}" for why, number in sorted(lost.items())) or "0",
        str(sum(t.unmarked.alarms for t in trials)),
    ]
    return f"| {what} | {' | '.join(cells)} |"


def _offsets(trials: Sequence[Trial]) -> Iterator[str]:
    """Tell how late the bounds found are, where the action is named rightly."""
    found = [(t.unmarked.event, t.events[OURS]) for t in trials if t.unmarked.event is not None and t.named]
    late_s = {
        "start": [(event.start_ns - marked.start_ns) / SECOND_NS for event, marked in found],
        "end": [(event.end_ns - marked.end_ns) / SECOND_NS for event, marked in found],
    }
    yield f"| found too late by, s | {' | '.join(f'{quantile:.0%}' for quantile in QUANTILES)} |"
    yield f"|---|{'---|' * len(QUANTILES)}"
    for bound, of_bound in late_s.items():
        yield f"| {bound} | {' | '.join(f'{late:.2f}' for late in np.quantile(of_bound, QUANTILES))} |"


@cache
def _contacts(name: str, spacing_m: float) -> list[Trial]:
    conditions = load_conditions()[name].model_copy(update={"spacing_m": spacing_m})
    first = FIRST_IN_CONTACT + CONTACT_PEOPLE * (len(SPACINGS_M) * list(load_conditions()).index(name))
    people = range(first, first + CONTACT_PEOPLE * len(SPACINGS_M))[SPACINGS_M.index(spacing_m) :: len(SPACINGS_M)]
    return _trials(
        Scene([Task(action, IDS[(person + i) % 3]) for i, action in enumerate(CONTACT)], person, conditions, IMAGE_HZ)
        for person in people
    )


@cache
def _pointings(distance_m: float) -> list[Trial]:
    far = Conditions(spacing_m=POINTING_SPACING_M, distance_m=distance_m)
    programme = [Task("point", number) for number in IDS]
    first = FIRST_PERSON + POINTING_PEOPLE * POINTING_DISTANCES_M.index(distance_m)
    people = range(first, first + POINTING_PEOPLE)
    return _trials(Scene(programme, person, far, STILL_IMAGE_HZ) for person in people)


@cache
def _pantomimes(empty_m: float) -> list[Trial]:
    programme = [Pantomime(action) for action in CONTACT]
    people = count(FIRST_PERSON + round(1e5 * empty_m))
    return _trials(
        Scene(programme, next(people), _empty(name, spacing_m, empty_m), IMAGE_HZ)
        for name in EMPTY_CONDITIONS
        for spacing_m in EMPTY_SPACINGS_M
        for _ in range(EMPTY_PEOPLE)
    )


@cache
def _returnings(name: str, way: Way) -> list[Trial]:
    """Return the trials of some people, in rows of each spacing; a lifted thing cannot be left where it is."""
    cell = len(WAYS) * RETURNING_CONDITIONS.index(name) + WAYS.index(way)
    actions = [action for action in (*CONTACT, "point") if (action, way) != ("lift", WAYS[0])]
    trials = []
    for number in range(RETURNING_PEOPLE):
        person = FIRST_RETURNING + RETURNING_PEOPLE * cell + number
        conditions = load_conditions()[name].model_copy(update={"spacing_m": SPACINGS_M[number % len(SPACINGS_M)]})
        programme = [Task(action, IDS[(person + i) % 3]) for i, action in enumerate(actions)]
        trials += trials_from_rest_to_rest(programme, person, conditions, way)
    return trials


def _object_right(trial: Trial) -> bool:
    return trial.object_right(OURS)


def _empty(name: str, spacing_m: float, empty_m: float) -> Conditions:
    near = {} if empty_m == EMPTY_M[-1] else {"pantomime_m": empty_m}
    return load_conditions()[name].model_copy(update={"spacing_m": spacing_m, **near})


def _nearness(empty_m: float) -> str:
    near = f"{100 * empty_m:.0f} cm"
    return f"{near} or more" if empty_m == EMPTY_M[-1] else f"{near} to {100 * empty_m + 5:.0f} cm"


def _trials(scenes: Iterator[Scene]) -> list[Trial]:
    return [trial for scene in scenes for trial in scene.trials()]
