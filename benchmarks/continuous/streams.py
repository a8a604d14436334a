"""The public sets as continuous streams, each with its frames as our classifier gets them and as its peers do."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from benchmarks.originals import ImportedSets
from benchmarks.recognition.datasets import with_joints
from numpy.typing import NDArray

from actum.node import Node
from actum.recording import Recording
from actum_dataset_importer.importing import import_msrc12_composed, import_msrc12_trimmed, import_utkinect
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.continuous.watching import views_of, watched
from actum_model_trainer.recorded_segments import FrameCollector
from actum_model_trainer.sample_reading import sample_of, samples_from
from actum_model_trainer.samples import Samples, SegmentSample
from scene_simulator.everyday import ALL, FAMILIAR, Everyday
from som_classifier.model import Recognition

from .simulated import TAUGHT, TAUGHT_REPETITIONS, TESTED, TESTED_REPETITIONS, recording_of

Array = NDArray[np.float64]
FOLDS = 5


@dataclass(frozen=True, eq=False)
class Stream:
    """One recording of one person.

    Attributes:
        whole: all of its valid frames as one sample without a label.
        camera_m: (n, 15, 3), the same frames in camera axes, bones of standard length, from the middle of the hips.
        agent: the person's number in it.
        truths: what was done.
        seen: when the person was seen.
        taught: what can be learnt from it.
    """

    recording: Recording
    whole: SegmentSample
    camera_m: Array
    agent: int
    truths: list[Truth]
    seen: list[Stretch]
    taught: Samples

    @property
    def person(self) -> int:
        return int(self.recording.person)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The stamps of its frames, (n,)."""
        return self.whole.stamps_ns

    @cached_property
    def rows(self) -> NDArray[np.float32]:
        """`camera_m` as rows (n, 45), 0 for what was never seen."""
        return np.nan_to_num(self.camera_m).reshape(-1, 45).astype(np.float32)

    def detection(self, first: int, last: int, decided: int, label: str, confidence: float) -> Detection:
        """Return the detection of an action between two of its frames, decided at a third."""
        start_ns, end_ns, decided_ns = (int(self.stamps_ns[i]) for i in (first, last, decided))
        return Detection(str(self.recording.path), self.agent, start_ns, end_ns, decided_ns, label, confidence)

    def answered(self, first: int, last: int, decided: int, answer: Recognition) -> Detection:
        """Return the detection of what our classifier answers to these frames."""
        found = self.detection(first, last, decided, answer.label, answer.confidence)
        return replace(found, familiarity=answer.familiarity)

    def frames_of(self, truth: Truth) -> tuple[int, int]:
        """Return the first and the last of its frames within a truth; the last is before the first where none is."""
        first = np.searchsorted(self.stamps_ns, truth.start_ns, side="left")
        last = np.searchsorted(self.stamps_ns, truth.end_ns, side="right") - 1
        return int(first), int(last)


@dataclass(frozen=True, eq=False)
class Fold:
    """Who is learnt from and who is tested."""

    training: tuple[Stream, ...]
    test: tuple[Stream, ...]


class ContinuousSets:
    """The streams of the public sets and of simulated people, imported into a folder when first asked for."""

    def __init__(self, imported: Path) -> None:
        self.imported, self._sets = imported, ImportedSets(imported)

    @cached_property
    def utkinect(self) -> list[Stream]:
        return list(map(stream_of, self._sets.recordings("utkinect", import_utkinect)))

    @cached_property
    def composed(self) -> list[Stream]:
        """Two streams of mixed gestures of each person of MSRC-12."""
        return list(map(stream_of, self._sets.recordings("msrc12", import_msrc12_composed)))

    @cached_property
    def natural(self) -> list[Stream]:
        """The first file of each gesture and person of MSRC-12 in which the gesture was marked."""
        first: dict[tuple[str, str], Recording] = {}
        for recording in self._sets.recordings("msrc12", import_msrc12_trimmed):
            first.setdefault((recording.person, recording.metadata["gesture"].rstrip("A")), recording)
        return [stream_of(recording) for recording in first.values() if recording.action_points_ns]

    @cached_property
    def simulated(self) -> "Fold":
        """The people of the simulated scene: who teaches, and others who do more kinds of things besides."""
        taught = [
            recording_of(person, TAUGHT_REPETITIONS, Everyday(FAMILIAR), self.imported / "simulated")
            for person in TAUGHT
        ]
        tested = [
            recording_of(person, TESTED_REPETITIONS, Everyday(ALL), self.imported / "simulated") for person in TESTED
        ]
        return Fold(tuple(map(stream_of, taught)), tuple(map(stream_of, tested)))


def folds(training: Sequence[Stream], test: Sequence[Stream]) -> list[Fold]:
    """Sort the people; fold f tests people f, f + 5, … and learns from all others."""
    people = sorted({stream.person for stream in training})
    left_out = [set(people[fold::FOLDS]) for fold in range(FOLDS)]
    return [
        Fold(
            tuple(stream for stream in training if stream.person not in tested),
            tuple(stream for stream in test if stream.person in tested),
        )
        for tested in left_out
    ]


def stream_of(recording: Recording) -> Stream:
    """Read a recording of one person before one sensor."""
    collector = FrameCollector()
    known = replayed(collector, recording)
    ((agent, frames),) = collector.frames.items()
    whole = sample_of(frames, "", recording, "whole")
    (example,) = with_joints([whole], [recording])
    taught = samples_from([recording])
    return Stream(recording, whole, example.camera_m, agent, list(known.truths), list(known.seen), taught)


def replayed(node: Node, recording: Recording) -> Found:
    """Replay a recording before one sensor without its marks, through the preprocessor and this classifier."""
    ((sensor, file),) = views_of(recording)
    return watched(node, recording, sensor, file)
