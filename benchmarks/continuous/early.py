"""What is said while an action goes on: which one it is, how complete it is, and how often that is said of none."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Literal

import numpy as np
from benchmarks.recognition.scores import percent, table

from actum.messages import Action, Message, Posture
from actum.node import Node, Tick
from actum_model_trainer.continuous.detections import Found, Truth
from actum_model_trainer.continuous.scoring import background_min
from som_classifier.model import Model
from som_classifier.node import SomClassifier

from .bench import Bench, number
from .streams import Fold, Stream, folds, replayed

SHARES = (0.5, 0.8)
"""How much of an action is over when it is asked which one it seems to be."""
Named = Literal["right", "another", "none"]


@dataclass(frozen=True)
class Saying:
    """What is said with one posture; label and completeness are None where nothing seems to go on."""

    stamp_ns: int
    label: str | None = None
    completeness: float | None = None


@dataclass(frozen=True)
class Heard:
    """What was said in one recording, of each agent in order, and what was true."""

    said: Mapping[int, Sequence[Saying]]
    found: Found


class Listener:
    """A node around the classifier that notes what it says with each posture."""

    def __init__(self, node: Node) -> None:
        self.name, self.inputs, self.counters = node.name, node.inputs, node.counters
        self.said: dict[int, list[Saying]] = {}
        self._node = node

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        answers = list(self._node.handle(message))
        if isinstance(message, Posture):
            saying = Saying(message.stamp_ns)
            for answer in answers:
                if isinstance(answer, Action) and not answer.final:
                    saying = Saying(message.stamp_ns, answer.action, answer.completeness)
            self.said.setdefault(message.agent, []).append(saying)
        return answers


def early(bench: Bench) -> Iterator[str]:
    """Partial answers, without marks."""
    people = folds(bench.data.utkinect, bench.data.utkinect)
    sets = {"UTKinect": people, "simulated scene, new people": [bench.data.simulated]}
    yield """While something goes on, partial answers name it. Named: the action that the newest partial answer names
when so much of a true one is over. Completeness: mean distance between what is said and the share that is over,
wherever the right action is named. False: a name that is said from one posture to the next, without a break, and not
during any true action, counted once; silent: the share of background postures with which nothing is named."""
    columns = [f"right, another, none named at {share:.0%}, %" for share in SHARES]
    header = ("", *columns, "completeness off by", "false / min", "silent, %")
    yield table(header, [_row(name, _heard(bench, of_set)) for name, of_set in sets.items()])


def heard(model: Model, stream: Stream) -> Heard:
    """Listen while a recording is replayed without its marks."""
    listener = Listener(SomClassifier(model))
    found = replayed(listener, stream.recording)
    return Heard(listener.said, found)


def named(own: Heard, share: float) -> Counter[Named]:
    """Count the truths of which, when a share of them is over, the right action is named, another one, or none."""
    counts: Counter[Named] = Counter()
    for truth in own.found.truths:
        until_ns = truth.start_ns + round(share * (truth.end_ns - truth.start_ns))
        said = [each for each in _during(own, truth) if each.stamp_ns <= until_ns]
        label = said[-1].label if said else None
        counts["none" if label is None else "right" if label == truth.label else "another"] += 1
    return counts


def completeness_errors(own: Heard) -> list[float]:
    """Return how far off each completeness is that is said while the right action is named."""
    return [
        abs(each.completeness - (each.stamp_ns - truth.start_ns) / (truth.end_ns - truth.start_ns))
        for truth in own.found.truths
        for each in _during(own, truth)
        if each.label == truth.label and each.completeness is not None
    ]


def false_names(own: Heard) -> int:
    """Count the names that are said from one posture to the next and never during a truth."""
    count = 0
    for agent, said in own.said.items():
        for label, run in groupby(said, key=lambda each: each.label):
            count += label is not None and not any(_is_during(each, own, agent) for each in run)
    return count


def silent(own: Heard) -> tuple[int, int]:
    """Count the postures outside all truths with which nothing is named, and all of these."""
    outside = [
        each.label for agent, said in own.said.items() for each in said if not _is_during(each, own, agent)
    ]  # fmt: skip
    return outside.count(None), len(outside)


def _heard(bench: Bench, people: Sequence[Fold]) -> list[Heard]:
    return [heard(bench.model_of(fold.training), stream) for fold in people for stream in fold.test]


def _row(name: str, everything: Sequence[Heard]) -> list[str]:
    counts = {share: sum((named(own, share) for own in everything), Counter()) for share in SHARES}
    truths = sum(len(own.found.truths) for own in everything)
    errors = [error for own in everything for error in completeness_errors(own)]
    minutes = sum(background_min(own.found.seen, own.found.truths) for own in everything)
    quiet, outside = np.sum([silent(own) for own in everything], axis=0)
    return [
        name,
        *(", ".join(percent(of[which] / truths) for which in ("right", "another", "none")) for of in counts.values()),
        number(float(np.mean(errors)) if errors else None),
        number(sum(map(false_names, everything)) / minutes),
        percent(quiet / outside),
    ]


def _during(own: Heard, truth: Truth) -> list[Saying]:
    return [each for each in own.said.get(truth.agent, ()) if truth.start_ns <= each.stamp_ns <= truth.end_ns]


def _is_during(saying: Saying, own: Heard, agent: int) -> bool:
    return any(
        truth.agent == agent and truth.start_ns <= saying.stamp_ns <= truth.end_ns for truth in own.found.truths
    )  # fmt: skip
