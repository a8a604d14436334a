"""What pushed one action's score over another's: each temporal cell's and each first map's share of the difference."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from actum.messages import Hand
from actum_model_inspector.anatomy import Floats, complete_weights
from som_classifier.first_layer import CHANNELS
from som_classifier.frames import Frame
from som_classifier.pyramid_model import PyramidModel


@dataclass(frozen=True, eq=False)
class Contributions:
    """Why one action's score is as much above another's as it is.

    score[winner] − score[second] = Σ units + level. What is heard is the maps of postures and of velocities, and that
    of arms for both arms.

    Attributes:
        winner: index of the action decided for.
        second: index of the other one.
        scores: of these two.
        units: (cells, heard, units of each), fourth root of the mean activity × (axis of the winner − axis of
            the second).
        level: the difference of their offsets, the same for every segment. Training sets it so that a segment as it
            had them on average leads to neither, or a little to the one that it had more often: then the units add up
            to about −level.
        activities: (cells, heard, units of each), their mean activity in each cell.
        in_mirror: whether the segment was read in a mirror, because the left arm acts.
        left_moves: whether the left arm is the part that moves most.
    """

    winner: int
    second: int
    scores: tuple[float, float]
    units: Floats
    level: float
    activities: Floats
    in_mirror: bool
    left_moves: bool

    @property
    def cells(self) -> Floats:
        """What each cell adds through each map that is heard, shape (cells, heard)."""
        added: Floats = self.units.sum(axis=2)
        return added

    @property
    def difference(self) -> float:
        """By how much the winner's score is above the second's."""
        return self.scores[0] - self.scores[1]

    @property
    def arm(self) -> Hand:
        """Which arm the map of arms sees."""
        return "left" if self.in_mirror else "right"


def contributions(model: PyramidModel, frames: Sequence[Frame], instead: str | None = None) -> Contributions:
    """Take apart by how much the answer to a complete segment scores above another action.

    Args:
        model: that answers.
        frames: of the segment, encoded.
        instead: the other action; the one that answers next where None.
    """
    recognition = model.recognise(frames, complete=True)
    winner = model.labels.index(recognition.label)
    others = [label for label in model.labels if label != recognition.label]
    second = model.labels.index(instead or max(others, key=lambda label: recognition.activations[label]))
    codes = [frame.activity for frame in frames]
    weights = complete_weights(model, frames)
    scores = model.scores(codes, weights)
    units = np.zeros((model.pyramid.cells, len(CHANNELS), len(model.first.postures.weights)))
    for axes, weight in zip(model.stages.axes, weights, strict=True):
        if weight:
            units += weight * (axes[:, winner] - axes[:, second]).reshape(units.shape)
    vector = model.pyramid.vector(model.prefix_sums(codes)).reshape(units.shape)
    offsets = np.array(weights) @ model.stages.offsets
    return Contributions(
        winner, second, (float(scores[winner]), float(scores[second])), units * vector,
        float(offsets[winner] - offsets[second]), vector**4,
        model.reads_in_mirror(codes), recognition.part == "left_arm",
    )  # fmt: skip
