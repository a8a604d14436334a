"""The public sets, imported as `actum import` does, each sequence as our recogniser gets it and as its peers do."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from benchmarks.originals import ImportedSets, original
from numpy.typing import NDArray

from actum import keys, standard_body
from actum.messages import Agent, Skeleton
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_dataset_importer.importing import (
    import_msr_action3d,
    import_msrc12,
    import_msrc12_trimmed,
    import_utkinect,
)
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample

from .videos import Pieces, import_exercise, import_florence

Array = NDArray[np.float64]

MSRC12_SEGMENTS = 5
"""How many segments of each gesture and person of MSRC-12 are drawn of the ten or more: 900 instead of 3105."""

MSRC12_SEGMENTS_OF_FEW = 10
"""How many there are to learn few examples from; the five are among them."""

MSRC12_SEED = 0

_NOBODY = "no person"
_HIPS = [INDEX["left_hip"], INDEX["right_hip"]]


@dataclass(frozen=True, eq=False)
class Example:
    """One labelled sequence.

    Attributes:
        sample: what our recogniser learns from.
        camera_m: (n, 15, 3), the same frames in camera axes, bones of standard length, from the middle of the hips;
            missing joints interpolated over time, NaN where one was never seen.
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
    """The sequences of the public sets, which are imported into a folder when first asked for."""

    def __init__(self, imported: Path) -> None:
        self._imported = ImportedSets(imported)

    @cached_property
    def msr(self) -> list[Example]:
        """The 557 sequences of MSR Action3D that are usually compared on."""
        return examples_of(self.msr_recordings)

    @cached_property
    def msr_recordings(self) -> list[Recording]:
        return self._imported.recordings("msr_action3d", import_msr_action3d)

    @cached_property
    def utkinect(self) -> list[Example]:
        """The labelled segments of UTKinect-Action3D."""
        return examples_of(self.utkinect_recordings)

    @cached_property
    def utkinect_recordings(self) -> list[Recording]:
        return self._imported.recordings("utkinect", import_utkinect)

    @cached_property
    def msrc12(self) -> list[Example]:
        """At most `MSRC12_SEGMENTS` segments of each gesture and person of MSRC-12, of those with anybody in them."""
        names = {sample.segment_id for sample in drawn(self._msrc12_samples, MSRC12_SEGMENTS, MSRC12_SEED)}
        return [example for example in self.msrc12_of_few if example.name in names]

    @cached_property
    def msrc12_of_few(self) -> list[Example]:
        """The same, at most `MSRC12_SEGMENTS_OF_FEW` of each."""
        samples = drawn(self._msrc12_samples, MSRC12_SEGMENTS_OF_FEW, MSRC12_SEED)
        return with_joints(samples, self._msrc12_recordings)

    @cached_property
    def _msrc12_samples(self) -> list[SegmentSample]:
        samples = samples_from(self._msrc12_recordings)
        if unusable := [left_out for left_out in samples.unusable if left_out.reason != _NOBODY]:
            raise ValueError(f"unusable: {unusable}")
        return samples.usable

    @cached_property
    def _msrc12_recordings(self) -> list[Recording]:
        return self._imported.recordings("msrc12", import_msrc12)

    @cached_property
    def msrc12_trimmed(self) -> list[Recording]:
        """The same streams, in which segments hold the gestures alone: between them people stand."""
        return self._imported.recordings("msrc12", import_msrc12_trimmed)

    @cached_property
    def florence(self) -> list[Example]:
        """The RGB clips of Florence 3D Actions, people 1 to 6, seen by the pose model that ACTUM_POSE_MODEL names."""
        return examples_of(self._imported.recordings("florence3d_rgb", import_florence))

    @cached_property
    def exercise(self) -> list[Example]:
        """Pieces of a video of somebody who does exercises, those in which anybody was seen by the same pose model."""
        pieces = [Pieces(recording.path) for recording in self._imported.recordings("people_video", import_exercise)]
        return with_joints(samples_from(pieces).usable, pieces)

    def action_set(self, number: int) -> list[Example]:
        """Return the sequences of AS1, AS2 or AS3 that are among the 557."""
        names = set(original(f"msr_action3d/ActionSet{number}.txt").read_text().split())
        return [example for example in self.msr if example.name in names]


def examples_of(recordings: Sequence[Recording]) -> list[Example]:
    """Cut out every labelled segment; one that our recogniser could not use would be missing for all, so none may be.

    Raises:
        ValueError: a segment cannot be used.
    """
    samples = samples_from(recordings)
    if samples.unusable:
        raise ValueError(f"unusable: {samples.unusable}")
    return with_joints(samples.usable, recordings)


def drawn(samples: Sequence[SegmentSample], at_most: int, seed: int) -> list[SegmentSample]:
    """Draw so many samples of each person and action, or all where there are fewer; they keep their order."""
    groups: dict[tuple[str, str], list[int]] = defaultdict(list)
    for index, sample in enumerate(samples):
        groups[sample.person, sample.label].append(index)
    rng = np.random.default_rng(seed)
    chosen = [index for group in sorted(groups) for index in rng.permutation(groups[group])[:at_most].tolist()]
    return [samples[index] for index in sorted(chosen)]


def with_joints(samples: Sequence[SegmentSample], recordings: Sequence[Recording]) -> list[Example]:
    """Put beside each sample its joints in camera axes, from the recordings that it was cut out of."""
    by_file = {str(recording.path): joints_by_stamp(recording) for recording in recordings}
    return [Example(sample, _camera_m(sample, by_file[sample.file])) for sample in samples]


def joints_by_stamp(recording: Recording) -> dict[int, Array]:
    """Return the joints (15, 3; m, camera axes, NaN where missing) of the first person at each stamp (ns)."""
    skeletons: Iterable[Skeleton] = (
        message for message in recording.messages((keys.SKELETON,)) if isinstance(message, Skeleton)
    )
    return {skeleton.stamp_ns: _array(skeleton.agents[0]) for skeleton in skeletons if skeleton.agents}


def _array(agent: Agent) -> Array:
    return np.array([joint or [np.nan] * 3 for joint in agent.joints])


def _camera_m(sample: SegmentSample, joints_m: dict[int, Array]) -> Array:
    seen = np.stack([joints_m[int(stamp_ns)] for stamp_ns in sample.stamps_ns])
    scaled = np.stack([standard_body.scaled(frame) for frame in interpolated(seen.reshape(-1, 45)).reshape(seen.shape)])
    relative: Array = scaled - scaled[:, _HIPS].mean(axis=1, keepdims=True)
    return relative


def interpolated(rows: Array) -> Array:
    """Interpolate over time what is missing (NaN) of each component; what is never there stays missing."""
    if not np.isnan(rows).any():
        return rows
    complete = rows.copy()
    for component, known in enumerate(~np.isnan(rows.T)):
        if known.any():
            complete[:, component] = np.interp(np.arange(len(rows)), np.flatnonzero(known), rows[known, component])
    return complete
