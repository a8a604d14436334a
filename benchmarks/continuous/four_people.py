"""What four people at once cost the preprocessor and the classifier, in a process of their own.

python -m benchmarks.continuous.four_people MODEL

Prints `Cost` as JSON. Times are the processor's, so that what else the machine does does not count.
"""

import gc
import json
import os
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import islice
from pathlib import Path
from types import BuiltinFunctionType, FunctionType, ModuleType

import numpy as np

from actum.messages import Action, Posture, Skeleton
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.everyday import ALL, Everyday
from scene_simulator.group import Group
from scene_simulator.programme import balanced_programme
from som_classifier.model import Model
from som_classifier.model_loading import load_model
from som_classifier.node import SomClassifier
from som_classifier.segmentation import Segmentation
from som_classifier.spotting.search import SearchPlan
from som_classifier.spotting.spotted import Spotter

PEOPLE, FIRST, REPETITIONS = 4, 60, 15
"""How many, the first one's number, and how often each does each of the five actions: it takes them 25 minutes."""
MINUTES, ALONE_MINUTES = 20.0, 5.0
"""How long all are watched, and how long each is once more without the others."""
FRAMES_PER_MIN = 30 * 60
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
MB = 1e6
Told = tuple[int, int, int, int, str, float]
"""Agent, instant of the decision, start and end (ns), action and confidence of an answer."""


@dataclass(frozen=True)
class Memory:
    """Of the process (resident), of all that the classifier keeps beside its model, and of the spotters alone, MB."""

    resident_mb: float
    classifier_mb: float
    spotters_mb: float


@dataclass(frozen=True)
class Cost:
    """What it costs.

    Attributes:
        minutes: how long all were watched.
        posture_ms: of one posture in the classifier: median, 99th percentile, largest.
        frame_ms: of one frame of all people in preprocessor and classifier, the same.
        core: the share of a core at 30 frames a second.
        early, late: after a minute, and in the end.
        told: answers to the four.
        alone: for each of them, answers at first without the others, and whether they are the same as among these.
    """

    minutes: float
    posture_ms: tuple[float, float, float]
    frame_ms: tuple[float, float, float]
    core: float
    early: Memory
    late: Memory
    told: int
    alone: list[tuple[int, bool]]


@dataclass(frozen=True)
class KeptSpotters(Segmentation):
    """Segmentation that keeps the spotters it leads to, to weigh them."""

    made: list[Spotter | None] = field(default_factory=list)

    def plan(self, model: Model) -> SearchPlan:
        plan = super().plan(model)

        def kept() -> Spotter | None:
            self.made.append(plan.spotter())
            return self.made[-1]

        return replace(plan, spotter=kept)


class Watchers:
    """Preprocessor and classifier, timed."""

    def __init__(self, model: Model) -> None:
        self._model, self._segmentation = model, KeptSpotters()
        self._preprocessor = PosePreprocessor(PoseSettings.defaults())
        self._classifier = SomClassifier(model, segmentation=self._segmentation)
        self.posture_ms: list[float] = []
        self.frame_ms: list[float] = []
        self.told: list[Told] = []

    def watch(self, skeleton: Skeleton) -> None:
        """Take a frame of all people."""
        began_ns = time.process_time_ns()
        for posture in self._preprocessor.handle(skeleton):
            assert isinstance(posture, Posture)
            since_ns = time.process_time_ns()
            answers = list(self._classifier.handle(posture))
            self.posture_ms.append((time.process_time_ns() - since_ns) / 1e6)
            self.told += [
                (each.agent, skeleton.stamp_ns, each.start_ns, each.end_ns or 0, each.action or "", each.confidence)
                for each in answers
                if isinstance(each, Action) and each.final
            ]
        self.frame_ms.append((time.process_time_ns() - began_ns) / 1e6)

    def memory(self) -> Memory:
        seen: set[int] = set()
        reachable_bytes(self._model, seen)
        spotters = reachable_bytes(self._segmentation.made, seen)
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        classifier = spotters + reachable_bytes(self._classifier, seen)
        return Memory(pages * PAGE_BYTES / MB, classifier / MB, spotters / MB)


def people(minutes: float) -> Iterator[Skeleton]:
    """Yield the frames of four people who act and do everyday things."""
    programmes = [balanced_programme(REPETITIONS, FIRST + k, FIRST + k) for k in range(PEOPLE)]
    group = Group(programmes, FIRST, FIRST, everyday=Everyday(ALL))
    for messages in islice(group.frames(), round(minutes * FRAMES_PER_MIN)):
        yield from (message for message in messages if isinstance(message, Skeleton))


def reachable_bytes(root: object, seen: set[int]) -> int:
    """Return the size of an object and of all that it refers to, but of nothing seen before; note what is seen."""
    waiting, size = [root], 0
    while waiting:
        each = waiting.pop()
        if id(each) not in seen and not isinstance(each, (type, ModuleType, FunctionType, BuiltinFunctionType)):
            seen.add(id(each))
            size += sys.getsizeof(each)
            waiting += gc.get_referents(each)
            if isinstance(each, np.ndarray) and each.base is not None:
                waiting.append(each.base)
    return size


def cost_of(model: Model, minutes: float, alone_minutes: float) -> Cost:
    """Watch four people, and then each alone."""
    together = Watchers(model)
    early = together.memory()
    for number, skeleton in enumerate(people(minutes), start=1):
        together.watch(skeleton)
        if number == FRAMES_PER_MIN:
            early = together.memory()
    return Cost(
        minutes,
        quantiles(together.posture_ms),
        quantiles(together.frame_ms),
        sum(together.frame_ms) / len(together.frame_ms) / (1000 * 60 / FRAMES_PER_MIN),
        early,
        together.memory(),
        len(together.told),
        alone(model, together.told, alone_minutes),
    )


def alone(model: Model, together: Sequence[Told], minutes: float) -> list[tuple[int, bool]]:
    """Return how many answers each got among the others at first, and whether they are the same without these."""
    apart, newest_ns = {number: Watchers(model) for number in range(1, PEOPLE + 1)}, 0
    for skeleton in people(minutes):
        newest_ns = skeleton.stamp_ns
        for number, own in apart.items():
            agents = [each for each in skeleton.agents if each.agent == number]
            own.watch(skeleton.model_copy(update={"agents": agents}))
    first = [told for told in together if told[1] <= newest_ns]
    return [(len(own.told), own.told == [told for told in first if told[0] == number]) for number, own in apart.items()]


def quantiles(values_ms: list[float]) -> tuple[float, float, float]:
    """Return median, 99th percentile and the largest."""
    median, late = np.quantile(values_ms, (0.5, 0.99)).tolist()
    return median, late, max(values_ms)


if __name__ == "__main__":
    print(json.dumps(asdict(cost_of(load_model(Path(sys.argv[1])), MINUTES, ALONE_MINUTES))))
