"""The sets: recordings of people to learn from, and of other people whose postures are predicted."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from benchmarks.continuous.simulated import TAUGHT, TAUGHT_REPETITIONS, TESTED, TESTED_REPETITIONS, recording_of
from benchmarks.originals import ImportedSets

from actum import keys
from actum.messages import Posture
from actum.node import replay
from actum.recording import Recording
from actum_dataset_importer.importing import import_msr_action3d, import_msrc12_composed, import_utkinect
from actum_model_trainer.recorded_segments import FrameCollector, classifier_input
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import Samples
from scene_simulator.everyday import ALL, FAMILIAR, Everyday
from som_classifier.frames import Frame


@dataclass(frozen=True, eq=False)
class Divided:
    """One set.

    Attributes:
        taught: what the training people's recordings hold.
        tested: each tested person's streams, as lists of valid frames.
        recordings: those of the tested people.
    """

    taught: Samples
    tested: Mapping[str, Sequence[Sequence[Frame]]]
    recordings: Sequence[Recording]


class Sets:
    """The sets, imported into a folder when first asked for."""

    def __init__(self, imported: Path) -> None:
        self._folder, self._sets, self._divided = imported, ImportedSets(imported), dict[str, Divided]()

    @cached_property
    def names(self) -> Mapping[str, Callable[[], Divided]]:
        """The sets by their names."""
        return {
            "MSR Action3D": lambda: halves(self._sets.recordings("msr_action3d", import_msr_action3d)),
            "UTKinect": lambda: halves(self._sets.recordings("utkinect", import_utkinect)),
            "MSRC-12, composed": lambda: halves(self._sets.recordings("msrc12", import_msrc12_composed)),
            "simulated": self._simulated,
        }

    def divided(self, name: str) -> Divided:
        """Return a set, read when first asked for."""
        if name not in self._divided:
            self._divided[name] = self.names[name]()
        return self._divided[name]

    def _simulated(self) -> Divided:
        taught, tested = Everyday(FAMILIAR), Everyday(ALL)
        return divided(
            [recording_of(person, TAUGHT_REPETITIONS, taught, self._folder) for person in TAUGHT],
            [recording_of(person, TESTED_REPETITIONS, tested, self._folder) for person in TESTED],
        )


def halves(recordings: Sequence[Recording]) -> Divided:
    """Sort the people; learn from every second one, beginning with the first, and test the others."""
    people = sorted({int(recording.person) for recording in recordings})
    training = set(people[::2])
    return divided(
        [recording for recording in recordings if int(recording.person) in training],
        [recording for recording in recordings if int(recording.person) not in training],
    )


def divided(taught: Sequence[Recording], tested: Sequence[Recording]) -> Divided:
    """Read recordings to learn from and recordings to test."""
    by_person: dict[str, list[Sequence[Frame]]] = {}
    for recording in tested:
        by_person.setdefault(recording.person, []).extend(frames_of(recording))
    return Divided(samples_from(taught), by_person, tested)


def frames_of(recording: Recording) -> list[list[Frame]]:
    """Return the valid frames of each person before each sensor, as the classifier gets them."""
    found = []
    for sensor in sorted(recording.sensors(keys.SKELETON)):
        collector = FrameCollector()
        for _ in replay(collector, classifier_input(recording, sensor)):
            raise AssertionError("the collector puts nothing")
        found += list(collector.frames.values())
    return found


def postures_of(recording: Recording) -> list[Posture]:
    """Return the postures of everybody in a recording, as the classifier gets them."""
    sensors = sorted(recording.sensors(keys.SKELETON))
    messages = [message for sensor in sensors for _, message in classifier_input(recording, sensor)]
    return [message for message in messages if isinstance(message, Posture)]
