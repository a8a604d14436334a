"""A second recogniser, which only the tables know: nearest examples by dynamic time warping of hands and elbows.

As a program it is a classifier that knows this kind of model: `python tests/nearest_recogniser.py`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.scoring import background_min
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import actions_of, provenance
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.training import SEARCHES, TRAININGS
from som_classifier import __main__ as classifier
from som_classifier.attention import PART_NAMES
from som_classifier.frames import Frame
from som_classifier.model import Arrays, Model, ModelMetadata, Recognition
from som_classifier.model_loading import KINDS
from som_classifier.presets import PRESETS, Preset
from som_classifier.spotting.pyramid_spotter import RecentFrames
from som_classifier.spotting.spotted import (
    NOTHING,
    Ongoing,
    Spotted,
    SpottedSegment,
    Spotter,
    SpottingMetadata,
    SpottingOptions,
)

SEEN = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("elbow", "hand")]
INTERVAL_NS, LAG_NS = SECOND_NS // 10, SECOND_NS // 2
Paths = NDArray[np.float64]
"""Ways of the joints seen, (…, points, 12), metres from the torso."""


@dataclass(frozen=True)
class NearestPreset(Preset):
    """Points of a way, the likeness (0 to 1) from which a window is an action, and how many durations windows have."""

    kind: ClassVar[str] = "nearest"
    points: int
    alike: float
    windows: int


NEAREST = NearestPreset("nearest", points=10, alike=0.3, windows=3)


class NearestMetadata(ModelMetadata):
    kind: Literal["nearest"] = "nearest"
    scale_m: float = Field(gt=0)
    """Distance at which the likeness has fallen to 1/e."""
    windows_s: list[float] = Field(default_factory=list)
    spotting: SpottingMetadata | None = None


class JointsSeen:
    def encode(self, frame: Frame) -> Paths:
        assert frame.kinematics is not None
        return np.nan_to_num(frame.kinematics.posture[SEEN]).ravel()


@dataclass(frozen=True, eq=False)
class NearestModel(Model):
    """Examples (n, points, 12), and the index of each one's action (n,)."""

    metadata: NearestMetadata
    examples: Paths
    actions: NDArray[np.intp]

    def __post_init__(self) -> None:
        if self.examples.shape[:1] != self.actions.shape or self.examples.shape[2:] != (3 * len(SEEN),):
            raise ValueError(f"its examples are of shape {self.examples.shape}")

    @property
    def arrays(self) -> Arrays:
        return {"examples": self.examples, "actions": self.actions}

    @classmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "NearestModel":
        return cls(NearestMetadata.model_validate_json(metadata), arrays["examples"], arrays["actions"])

    def encoder(self) -> JointsSeen:
        return JointsSeen()

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        way = resampled(np.array([frame.activity for frame in frames]), self.examples.shape[1])
        likeness = np.exp(-warped_m(self.examples, way) / self.metadata.scale_m)
        best = [float(likeness[self.actions == n].max()) for n in range(len(self.labels))]
        winner, moved_m = int(np.argmax(best)), np.sum([frame.motion for frame in frames], axis=0)
        activations = dict(zip(self.labels, best, strict=True))
        return Recognition(self.labels[winner], best[winner], activations, PART_NAMES[int(moved_m.argmax())])

    @property
    def spotting(self) -> SpottingMetadata | None:
        return self.metadata.spotting

    def spotters(self, asked: Sequence[SpottingOptions]) -> list[Spotter]:
        return [] if self.spotting is None else [SlidingWindows(self, self.spotting) for _ in asked]


class SlidingWindows(Spotter):
    """Takes the likest of the windows that overlap once none that is liker has come for a while."""

    def __init__(self, model: NearestModel, learned: SpottingMetadata) -> None:
        self._model, self._learned = model, learned
        self._recent = RecentFrames(model.metadata.windows_s, 4 * SECOND_NS)
        self._best: tuple[float, SpottedSegment] | None = None
        self._next_ns = self._done_ns = 0

    def step(self, frame: Frame) -> Spotted:
        if not frame.valid:
            return NOTHING
        if not self._recent.add(frame):
            self._best, self._next_ns, self._done_ns = None, 0, 0
        if frame.stamp_ns >= self._next_ns:
            self._next_ns = frame.stamp_ns + INTERVAL_NS
            self._look(frame.stamp_ns)
        if self._best is None:
            return NOTHING
        confidence, found = self._best
        if frame.stamp_ns - found.end_ns < LAG_NS:
            return Spotted(ongoing=Ongoing(found.start_ns, found.label, confidence, 1.0))
        self._best, self._done_ns = None, found.end_ns
        return Spotted((found,))

    def _look(self, now_ns: int) -> None:
        frames, firsts = self._recent.windows()
        for window in (frames[first:] for first in firsts):
            answer = self._model.recognise(window, complete=True)
            is_best = answer.confidence > (self._best[0] if self._best else self._learned.threshold)
            if is_best and window[0].stamp_ns > self._done_ns:
                self._best = answer.confidence, SpottedSegment(window[0].stamp_ns, now_ns, answer.label)


def resampled(path: Paths, points: int) -> Paths:
    return path[np.linspace(0, len(path) - 1, points).round().astype(int)]


def warped_m(examples: Paths, path: Paths) -> NDArray[np.float64]:
    """Return the mean distance (m) of a way (points, 12) from each example along the best warping, (n,)."""
    costs_m = np.linalg.norm(examples[:, :, None] - path[None, None], axis=3)
    sums_m = np.full((len(examples), costs_m.shape[1] + 1, costs_m.shape[2] + 1), np.inf)
    sums_m[:, 0, 0] = 0
    for i, j in np.ndindex(*costs_m.shape[1:]):
        before_m = np.minimum(np.minimum(sums_m[:, i, j], sums_m[:, i, j + 1]), sums_m[:, i + 1, j])
        sums_m[:, i + 1, j + 1] = costs_m[:, i, j] + before_m
    means_m: NDArray[np.float64] = sums_m[:, -1, -1] / len(path)
    return means_m


def train(
    samples: Sequence[SegmentSample],
    _background: Sequence[LabelledStream],
    preset: NearestPreset,
    seed: int,
    progress: Progress,
) -> NearestModel:
    labels = actions_of(samples)
    ways = [np.nan_to_num(sample.postures[:, SEEN]).reshape(len(sample.postures), -1) for sample in samples]
    examples = np.stack([resampled(way, preset.points) for way in ways])
    actions = np.array([labels.index(sample.label) for sample in samples])
    progress("examples", len(samples), len(samples))
    apart_m = [np.partition(warped_m(examples, example), 1)[1] for example in examples]
    metadata = provenance(samples, preset, seed) | {"scale_m": max(2 * float(np.max(apart_m)), 0.01)}
    return NearestModel(NearestMetadata.model_validate(metadata), examples, actions)


def with_search(
    model: NearestModel, streams: Sequence[LabelledStream], preset: NearestPreset, seed: int, progress: Progress
) -> NearestModel:
    durations_s = [(end_ns - start_ns) / SECOND_NS for each in streams for start_ns, end_ns, _ in each.segments]
    marked = sum((each.marked for each in streams), Found())
    learned = SpottingMetadata(
        thresholds=[preset.alike],
        false_alarms_per_min=[],
        threshold=preset.alike,
        background_s=60 * background_min(marked.seen, marked.truths),
    )
    windows_s = np.quantile(durations_s, np.linspace(0, 1, preset.windows)).tolist()
    metadata = model.metadata.model_copy(update={"windows_s": windows_s, "spotting": learned})
    return NearestModel(metadata, model.examples, model.actions)


TABLES: tuple[tuple[dict[str, Any], Any], ...] = (
    (KINDS, NearestModel), (TRAININGS, train), (SEARCHES, with_search), (PRESETS, NEAREST),
)  # fmt: skip

if __name__ == "__main__":
    for table, own in TABLES:
        table[NEAREST.kind] = own
    classifier.main()
