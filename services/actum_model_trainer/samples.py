"""Training samples: the labelled segments of recordings, and the streams in which they lie."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.messages import NONE, Hand
from actum_model_trainer.continuous.detections import Found, Stretch, Truth
from actum_model_trainer.continuous.presence import LONGEST_BREAK_NS
from som_classifier.handedness import acting_hands, limb_moments


@dataclass(frozen=True, eq=False)
class SegmentSample:
    """One labelled segment: its n valid frames as the classifier gets them.

    Attributes:
        label: the action done.
        stamps_ns: (n,), rising.
        joints: (n, 15, 3), scaled to the standard body's metres, in the egocentric frame, NaN where missing.
        motion: (n, 5), mean displacement of each body part since the frame before, metres.
        postures: (n, 15, 3), scaled joints in the upright frame, low-passed, NaN where missing.
        velocities: (n, 15, 3), of the postures.
        person: who acts, as the recording names them.
        file: the recording's path.
        segment_id: of the segment in the recording.
        depth_inferred: whether some distances were inferred from an image and a standard body's size.
        sensor: the sensor of the frames.
    """

    label: str
    stamps_ns: NDArray[np.int64]
    joints: Array
    motion: Array
    postures: Array
    velocities: Array
    person: str
    file: str
    segment_id: str
    depth_inferred: bool = False
    sensor: str = ""

    @cached_property
    def acting_hands(self) -> list[Hand | None]:
        """For each frame, the side of the arm that has acted up to it; None for both arms or another limb."""
        summed = np.cumsum(limb_moments(self.postures), axis=0)
        return acting_hands(np.zeros_like(summed), summed)


@dataclass(frozen=True, eq=False)
class LabelledStream:
    """All n valid frames of one person in a recording, and what is done in them; the rest is background.

    Attributes:
        stamps_ns: (n,), rising.
        motion: (n, 5), mean displacement of each body part since the frame before, metres.
        postures: (n, 15, 3), scaled joints in the upright frame, low-passed, NaN where missing.
        velocities: (n, 15, 3), of the postures.
        segments: start and end (ns) and label of each labelled segment, `NONE` too, in the order in which they end.
        person: whose recording it is.
        file: the recording's path.
        agent: the person's number in it.
        depth_inferred: whether some distances were inferred from an image and a standard body's size.
    """

    stamps_ns: NDArray[np.int64]
    motion: Array
    postures: Array
    velocities: Array
    segments: tuple[tuple[int, int, str], ...]
    person: str
    file: str
    agent: int
    depth_inferred: bool = False

    @cached_property
    def marked(self) -> Found:
        """What the person did, and when the person was seen."""
        return Found(
            truths=[Truth(self.file, self.agent, *segment) for segment in self.segments if segment[2] != NONE],
            seen=[Stretch(self.file, self.agent, *run_ns) for run_ns in self.runs_ns],
        )

    @property
    def is_counterexample(self) -> bool:
        """Whether most of it is labelled as none of the actions."""
        of_none = [
            (self.stamps_ns >= start) & (self.stamps_ns <= end) for start, end, own in self.segments if own == NONE
        ]
        return bool(of_none) and bool(np.any(of_none, axis=0).mean() > 0.5)

    @property
    def runs_ns(self) -> list[tuple[int, int]]:
        """The first and the last stamp of each time in which the person was seen without a longer break."""
        after = np.flatnonzero(np.diff(self.stamps_ns) > LONGEST_BREAK_NS) + 1
        runs = np.split(self.stamps_ns, after)
        return [(int(run[0]), int(run[-1])) for run in runs]


@dataclass(frozen=True)
class Unusable:
    """A labelled segment that no sample can be made of, and the reason."""

    file: str
    segment_id: str
    reason: str
    sensor: str


@dataclass(frozen=True)
class Samples:
    """What recordings hold to learn from.

    Attributes:
        segments: the labelled segments, in the order in which they end.
        streams: the people's streams in which they lie.
    """

    segments: list[SegmentSample | Unusable]
    streams: list[LabelledStream]

    @cached_property
    def usable(self) -> list[SegmentSample]:
        """The segments of actions that a model can be trained on."""
        return [each for each in self.segments if isinstance(each, SegmentSample) and each.label != NONE]

    @cached_property
    def unusable(self) -> list[Unusable]:
        """The segments that no sample can be made of."""
        return [segment for segment in self.segments if isinstance(segment, Unusable)]
