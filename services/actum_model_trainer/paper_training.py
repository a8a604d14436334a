"""Training of the paper's recogniser, layer after layer (paper, sections 2.1 and 3)."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np

from actum.arrays import Array
from actum.som import Som
from actum_model_trainer.median_distances import median_neighbour_distance2, median_quantization_error2
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import actions_of, provenance
from actum_model_trainer.samples import LabelledStream, SegmentSample
from som_classifier.attention import PostureInput
from som_classifier.map_activity import MapActivity, map_activity, ordered_vector, soft_activity, trajectory
from som_classifier.paper_model import PaperMetadata, PaperModel
from som_classifier.presets import MapTraining, PaperPreset
from som_classifier.supervised import SupervisedLayer


@dataclass(frozen=True, eq=False)
class _AttendedSample:
    """A sample with the body part that the recogniser attends to.

    Attributes:
        rows: (frames, parts, size), the first map's input for each part.
        attended: the index of the part attended to.
    """

    rows: Array
    attended: int

    @classmethod
    def of(cls, sample: SegmentSample, posture: PostureInput) -> "_AttendedSample":
        """Choose the part as the preset says, among those that are seen in at least one frame."""
        rows = np.stack([posture.rows(*frame) for frame in zip(sample.joints, sample.postures, strict=True)])
        _, attended = posture.attended(sample.motion, np.any(np.isfinite(rows), axis=(0, 2)))
        return cls(rows, attended)

    @property
    def vectors(self) -> Array:
        """The first map's training vectors, shape (n, size), without frames in which the part is wholly missing."""
        vectors: Array = self.rows[:, self.attended]
        return vectors[~np.isnan(vectors).all(axis=1)]

    def trajectory(self, layer1: Som, contrast: float) -> Array:
        """Return the trajectory over the first map, shape (changes, 2).

        It is computed frame by frame by the same matrix products as in the recogniser, so that both agree to the bit.
        """
        frames = [map_activity(layer1, rows, contrast)[self.attended] for rows in self.rows]
        winners, centres = np.array([frame.winners for frame in frames]), np.array([frame.centres for frame in frames])
        return trajectory(MapActivity(winners, centres))


def train(
    samples: Sequence[SegmentSample],
    _background: Sequence[LabelledStream],
    preset: PaperPreset,
    seed: int,
    progress: Progress,
) -> PaperModel:
    """Train the three layers, one after the other; the same samples, preset and seed make the same model.

    The paper knows no background.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    labels = actions_of(samples)
    rng = np.random.default_rng(seed)
    attended = [_AttendedSample.of(sample, preset.posture) for sample in samples]
    postures = np.concatenate([sample.vectors for sample in attended])
    layer1 = _trained_map(preset.layer1, postures, rng, progress, "layer 1")
    centre_contrast = preset.centre_contrast * median_quantization_error2(layer1, postures)
    paths = [sample.trajectory(layer1, centre_contrast) for sample in attended]
    points = max(2, *map(len, paths))
    vectors = np.stack([ordered_vector(path, points) for path in paths])
    layer2 = _trained_map(preset.layer2, vectors, rng, progress, "layer 2")
    contrast = preset.relative_contrast * median_neighbour_distance2(vectors)
    activities = np.stack([soft_activity(layer2.excess2(vector), contrast) for vector in vectors])
    targets = np.array([labels.index(sample.label) for sample in samples])
    untrained = SupervisedLayer.random(len(labels), activities.shape[1], rng)
    layer3 = untrained.train(activities, targets, preset.beta, preset.epochs, rng, partial(progress, "layer 3"))
    measured = {"centre_contrast": centre_contrast, "points": points, "contrast": contrast}
    metadata = provenance(samples, preset, seed) | asdict(preset.posture) | measured
    return PaperModel(layer1, layer2, layer3, PaperMetadata.model_validate(metadata))


def _trained_map(plan: MapTraining, vectors: Array, rng: np.random.Generator, progress: Progress, stage: str) -> Som:
    untrained = Som.random(plan.rows, plan.cols, vectors.shape[1], rng)
    return untrained.train(vectors, plan.steps, plan.schedule, rng, partial(progress, stage))
