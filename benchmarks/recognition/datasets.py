"""The public sets, imported as `actum import` does, each sequence as our recogniser gets it and as its peers do."""

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum import geometry, keys
from actum.messages import Agent, Skeleton
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_command.importing import ImportReport, Progress, import_msr_action3d, import_utkinect
from model_trainer.samples import SegmentSample, samples_from, select

Array = NDArray[np.float64]
Import = Callable[[Path, Path, Progress], ImportReport]
_HIPS = [INDEX["left_hip"], INDEX["right_hip"]]


@dataclass(frozen=True, eq=False)
class Example:
    """One labelled sequence.

    Attributes:
        sample: what our recogniser learns from.
        camera_m: (n, 15, 3), the same frames in camera axes, bones of standard length, from the middle of the hips.
    """

    sample: SegmentSample
    camera_m: Array

    @property
    def label(self) -> str:
        return self.sample.label

    @property
    def person(self) -> int:
        return int(self.sample.person)

    @property
    def name(self) -> str:
        return self.sample.segment_id


class Datasets:
    """The sets below one folder; each is imported into another when first asked for."""

    def __init__(self, originals: Path, imported: Path) -> None:
        self._originals, self._imported = originals, imported

    @classmethod
    def from_environment(cls, imported: Path) -> "Datasets":
        """Find the folder that ACTUM_DATA names."""
        folder = os.environ.get("ACTUM_DATA")
        if not folder or not Path(folder).is_dir():
            raise SystemExit("set ACTUM_DATA to the folder that holds msr_action3d/ and utkinect/")
        return cls(Path(folder), imported)

    @cached_property
    def msr(self) -> list[Example]:
        """The 557 sequences of MSR Action3D that are usually compared on."""
        return examples_of(self.msr_recordings)

    @cached_property
    def msr_recordings(self) -> list[Recording]:
        return self._recordings("msr_action3d", import_msr_action3d)

    @cached_property
    def utkinect(self) -> list[Example]:
        """The labelled segments of UTKinect-Action3D."""
        return examples_of(self._recordings("utkinect", import_utkinect))

    def action_set(self, number: int) -> list[Example]:
        """Return the sequences of AS1, AS2 or AS3 that are among the 557."""
        names = set((self._originals / "msr_action3d" / f"ActionSet{number}.txt").read_text().split())
        return [example for example in self.msr if example.name in names]

    def _recordings(self, name: str, import_set: Import) -> list[Recording]:
        import_set(self._originals / name, self._imported / name, lambda done, total: None)
        return select([self._imported / name])


def examples_of(recordings: Sequence[Recording]) -> list[Example]:
    """Cut out every labelled segment; one that our recogniser could not use would be missing for all, so none may be.

    Raises:
        ValueError: a segment cannot be used.
    """
    samples = samples_from(recordings)
    if samples.unusable:
        raise ValueError(f"unusable: {samples.unusable}")
    by_file = {str(recording.path): _by_stamp(recording) for recording in recordings}
    return [Example(sample, _camera_m(sample, by_file[sample.file])) for sample in samples.usable]


def _by_stamp(recording: Recording) -> dict[int, Array]:
    skeletons: Iterable[Skeleton] = (
        message for message in recording.messages((keys.SKELETON,)) if isinstance(message, Skeleton)
    )
    return {skeleton.stamp_ns: _array(skeleton.agents[0]) for skeleton in skeletons if skeleton.agents}


def _array(agent: Agent) -> Array:
    return np.array([joint or [np.nan] * 3 for joint in agent.joints])


def _camera_m(sample: SegmentSample, joints_m: dict[int, Array]) -> Array:
    scaled = np.stack([geometry.scaled(joints_m[int(stamp_ns)]) for stamp_ns in sample.stamps_ns])
    relative: Array = scaled - scaled[:, _HIPS].mean(axis=1, keepdims=True)
    return relative
