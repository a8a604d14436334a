"""What each action was done to before, as evidence of what follows, of people with habits and without.

Simulated people through preprocessor, classifier and fusion, their actions marked.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from benchmarks.intent import pairs
from benchmarks.intent.pairs import Watched, contacts_in, received_in, stamps_of
from benchmarks.intent.takes import LAYOUTS, scene_with_habits

from action_fusion.intake.stream_samples import objects_sample, posture_sample
from action_fusion.intent.intents import Intents
from action_fusion.intent.recent_paths import ARMS
from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.arrays import Array
from actum.messages import Action, Intent, Message, Objects, Posture
from actum.node import Counters
from actum_model_trainer.foreseeing.scoring import (
    BEFORE_S,
    Said,
    before,
    earliest,
    expected_calibration_error,
    outcomes,
)
from actum_model_trainer.foreseeing.takes import Take
from scene_simulator.simulated_scene import Scene

TASKS = 25
"""Actions of a person: five of each kind."""
SHARES = {"80 % of each action to one object": 0.8, "objects at random": 0.0}
"""Share of each action that is done to the object that is usual for it, in words and as a number."""
DRAWS = 200
"""Drawings of as many people, with replacement, from which an interval is computed."""
HEAD = (
    "| objects | people | evidence | object right "
    + " | object right ".join(f"{s} s before" for s in BEFORE_S)
    + " | pair right "
    + " | pair right ".join(f"{s} s before" for s in BEFORE_S)
    + " | time ahead (s) | Brier 0.5 s before | calibration error, object | calibration error, pair |\n|---:|---|---|"
    + "---:|" * (2 * len(BEFORE_S) + 4)
)


class Both(NamedTuple):
    """What is said without the events, and with them."""

    without: Watched
    given: Watched


def table(persons: Sequence[int], seed: int) -> Iterator[str]:
    """Yield what is said before the contacts of these people."""
    yield (
        f"{len(persons)} people, {TASKS} actions each, done to three of the objects. The usual object of each action "
        "was drawn for each person; two actions may have the same. Without the evidence, no event reaches the intents. "
        f"In brackets: 90 % interval of {DRAWS} drawings of people. Errors of drawings are too large rather than too "
        "small, as they cannot be negative."
    )
    rows = [HEAD]
    for layout in (LAYOUTS[1], LAYOUTS[3]):
        for name, share in SHARES.items():
            said = [_said_of(scene_with_habits(person, seed, *layout, TASKS, share)) for person in persons]
            rows.append(_row(f"{layout[0]} | {name} | without", [each.without for each in said]))
            rows.append(_row(f"{layout[0]} | {name} | with", [each.given for each in said]))
    yield "\n".join(rows)


def _row(name: str, said: Sequence[Watched]) -> str:
    scored = [_scored(each) for each in said]
    numbers = [
        *(_objects_right(said, seconds) for seconds in BEFORE_S),
        *(pairs.pairs_right(said, seconds) for seconds in BEFORE_S),
        earliest(scored).median_s,
        before(scored, 0.5).brier,
    ]
    errors = [_error(list(map(outcomes, scored))), _error(list(map(pairs.outcomes, said)))]
    return f"| {name} | {' | '.join([*(f'{each:.2f}' for each in numbers), *errors])} |"


def _error(people: Sequence[Array]) -> str:
    """Return the expected calibration error of people's probabilities, with its interval."""
    rng = np.random.default_rng(0)
    drawn = rng.integers(0, len(people), (DRAWS, len(people)))
    errors = [expected_calibration_error(np.concatenate([people[k] for k in each])) for each in drawn]
    low, high = np.quantile(errors, (0.05, 0.95))
    return f"{expected_calibration_error(np.concatenate(people)):.3f} ({low:.3f}–{high:.3f})"


def _said_of(scene: Scene) -> Both:
    """Let the fusion say what it does, and beside it intents that get no event."""
    fusion, apart, received = ActionFusion(Settings()), Intents(), [*received_in(scene)]
    given, without = [], []
    for message in received:
        given += [put for put in fusion.handle(message) if isinstance(put, Intent)]
        without += _apart(apart, message)
    contacts, stamps_ns = contacts_in(scene), stamps_of(received)
    return Both(Watched(contacts, stamps_ns, without), Watched(contacts, stamps_ns, given))


def _apart(intents: Intents, message: Message) -> list[Intent]:
    counters = Counters()
    match message:
        case Posture():
            sample = posture_sample(message, counters)
            said = None if sample.body is None else intents.posture(sample, message.agent, message.sensor)
            return [] if said is None else [said]
        case Objects():
            intents.objects(objects_sample(message, counters))
        case Action():
            intents.action(message)
    return []


def _objects_right(said: Sequence[Watched], seconds: float) -> float:
    likeliest = [pair for each in said for pair in each.likeliest(seconds)]
    return float(np.mean([first is not None and first.object_id == contact.number for contact, first in likeliest]))


def _scored(watched: Watched) -> Said:
    """Return what was said as scores of each posture; an object that is not named counts as impossible."""
    stamps_ns = np.array(watched.stamps_ns)
    named = {each.object_id for intent in watched.intents for each in intent.intended}
    numbers = sorted(named | {contact.number for contact in watched.contacts})
    scores = np.zeros((len(stamps_ns), len(numbers)))
    for intent in watched.intents:
        row = int(np.searchsorted(stamps_ns, intent.stamp_ns))
        for each in intent.intended:
            scores[row, numbers.index(each.object_id)] = each.soon_probability
    unseen = np.full((len(stamps_ns), len(ARMS), 3), np.nan)
    places = {number: np.full((len(stamps_ns), 3), np.nan) for number in numbers}
    return Said(Take("habits", stamps_ns, unseen, places, watched.contacts), scores)
