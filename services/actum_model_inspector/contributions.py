"""Attribution of the difference between two actions' scores to the pyramid's cells and the first layer's units.

Scores are linear in the pooled vector, so that the difference splits exactly into one contribution per component.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from actum.arrays import Floats
from actum.messages import Hand
from som_classifier.first_layer import CHANNELS
from som_classifier.frames import Frame
from som_classifier.model_maps import complete_weights
from som_classifier.pyramid_model import PyramidModel


@dataclass(frozen=True, eq=False)
class Contributions:
    """The difference between the scores of the action answered and of another one, as a sum of contributions.

    score[winner] − score[other] = Σ units + bias.

    Attributes:
        winner: index of the action answered.
        other: index of the action it is compared with.
        scores: of these two.
        units: (cells, channels, units of a map), each one's contribution: fourth root of its mean activity × (axis of
            the winner − axis of the other). The channels are `som_classifier.first_layer.CHANNELS`.
        bias: the difference of the offsets, the same for every segment. Training sets it so that an average segment
            gives neither action a lead, or a slight one to the more frequent action: its units sum up to about −bias.
        activities: (cells, channels, units of a map), mean activities.
        in_mirror: whether the model read the segment as its mirror image, because the left arm acts.
        left_moves: whether the left arm is the body part that moves most.
    """

    winner: int
    other: int
    scores: tuple[float, float]
    units: Floats
    bias: float
    activities: Floats
    in_mirror: bool
    left_moves: bool

    @property
    def cells(self) -> Floats:
        """The contribution of each cell through each channel, shape (cells, channels)."""
        sums: Floats = self.units.sum(axis=2)
        return sums

    @property
    def difference(self) -> float:
        """The winner's score less the other's."""
        return self.scores[0] - self.scores[1]

    @property
    def arm(self) -> Hand:
        """The arm that the arm map's channel for the acting arm reads."""
        return "left" if self.in_mirror else "right"


def contributions(model: PyramidModel, frames: Sequence[Frame], compared_with: str | None = None) -> Contributions:
    """Attribute the difference between the scores of the answer to a complete segment and of another action.

    Args:
        model: that answers.
        frames: of the segment, encoded.
        compared_with: the other action; where None, the one with the next largest activation.
    """
    recognition = model.recognise(frames, complete=True)
    winner = model.labels.index(recognition.label)
    rivals = [label for label in model.labels if label != recognition.label]
    other = model.labels.index(compared_with or max(rivals, key=lambda label: recognition.activations[label]))
    activities = [frame.activity for frame in frames]
    weights = complete_weights(model, frames)
    scores = model.scores(activities, weights)
    units = np.zeros((model.pyramid.cells, len(CHANNELS), len(model.first.postures.weights)))
    for axes, weight in zip(model.stages.axes, weights, strict=True):
        if weight:
            units += weight * (axes[:, winner] - axes[:, other]).reshape(units.shape)
    vector = model.pyramid.vector(model.prefix_sums(activities)).reshape(units.shape)
    offsets = np.array(weights) @ model.stages.offsets
    return Contributions(
        winner, other, (float(scores[winner]), float(scores[other])), units * vector,
        float(offsets[winner] - offsets[other]), vector**4,
        model.reads_in_mirror(activities), recognition.part == "left_arm",
    )  # fmt: skip
