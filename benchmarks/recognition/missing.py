"""What happens where joints are missing: they are taken out of the skeletons, and all else runs as live."""

from collections.abc import Callable, Collection, Iterator
from pathlib import Path

import numpy as np

from actum import keys
from actum.messages import Message, Skeleton
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.sample_reading import samples_from

from .bench import Bench
from .ours import OURS, PAPERS
from .scores import Score, table
from .splits import SEED, odd_even

Frames = Callable[[int], range]
FEET = ("left_foot", "right_foot")
LEGS = ("left_knee", "right_knee", *FEET)
RIGHT_ARM = ("right_elbow", "right_hand")


class Lacking(Recording):
    """A recording whose skeletons lack some joints in some frames."""

    def __init__(self, path: Path, joints: Collection[str], frames: Frames) -> None:
        super().__init__(path)
        self._joints = {INDEX[name] for name in joints}
        total = sum(1 for _ in super().messages((keys.SKELETON,)))
        self._frames = frames(total)

    def messages(self, topics: Collection[keys.Topic] | None = None) -> Iterator[Message]:
        """Yield what the recording holds, less those joints."""
        number = 0
        for message in super().messages(topics):
            if isinstance(message, Skeleton):
                yield self._without(message) if number in self._frames else message
                number += 1
            else:
                yield message

    def _without(self, skeleton: Skeleton) -> Skeleton:
        agents = [
            agent.model_copy(update={"joints": [None if i in self._joints else j for i, j in enumerate(agent.joints)]})
            for agent in skeleton.agents
        ]
        return skeleton.model_copy(update={"agents": agents})


def missing_joints(bench: Bench) -> Iterator[str]:
    """Trained on whole bodies, tested on parts."""
    yield """MSR Action3D, odd people trained on whole bodies, even people tested with joints taken out of the sensor's
skeletons; where the arm is missing it is so for one run of a third of the frames, at random in each sequence. The peers
take no missing joints."""
    header = ("missing", "recogniser", "accuracy %", "right", "95 % interval", "mean confidence")
    yield table(header, (row for case in _cases() for row in _rows(bench, *case)))


def _cases() -> Iterator[tuple[str, Collection[str], Frames]]:
    rng = np.random.default_rng(SEED)
    yield "nothing", (), range
    yield "both feet", FEET, range
    yield "both knees and feet", LEGS, range
    yield "right elbow and hand, a third of the frames", RIGHT_ARM, lambda total: _third(total, rng)


def _third(total: int, rng: np.random.Generator) -> range:
    length = round(total / 3)
    start = int(rng.integers(total - length + 1))
    return range(start, start + length)


def _rows(bench: Bench, case: str, joints: Collection[str], frames: Frames) -> Iterator[list[str]]:
    even = [recording for recording in bench.data.msr_recordings if int(recording.person) % 2 == 0]
    samples = samples_from([Lacking(recording.path, joints, frames) for recording in even]).usable
    for maps in (OURS, PAPERS):
        model = bench.fitted(maps, odd_even(bench.data.msr).training).model
        answers = [answer(model, encoded(model, sample)) for sample in samples]
        right = sum(own.label == sample.label for own, sample in zip(answers, samples, strict=True))
        confidence = f"{np.mean([own.confidence for own in answers]):.3f}"
        yield [case, maps.name, *Score(right, len(even)).cells, confidence]
