"""What all kinds of models have to look at: a map of postures, a map of actions, and what happens on them."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.som import Som
from model_inspector.bodies import LIMB, STANDING, WHOLE, Figure
from som_classifier.attention import UNSEEN, attended
from som_classifier.model import Model
from som_classifier.paper_model import PaperModel
from som_classifier.pyramid_model import PyramidModel
from som_classifier.streams import Frame
from som_classifier.supervised import activity
from som_classifier.trace import ordered_vector, without_repeats

Floats = NDArray[Any]
Indices = NDArray[np.intp]


class Anatomy(ABC):
    """The maps of one model.

    Attributes:
        postures: the first map.
        actions: the second map.
        figure: what its units' weights draw.
    """

    model: Model
    postures: Som
    actions: Som
    figure: Figure

    @abstractmethod
    def unit_points(self) -> Floats:
        """Return the joints that each unit of the first map stands for, relative to the torso, (units, joints, 3)."""

    @abstractmethod
    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the first map's winner at each encoded frame, UNSEEN where it has none, shape (n,)."""

    def in_mirror(self, frames: Sequence[Frame]) -> bool:
        """Tell whether a segment of encoded frames is read as its mirror image."""
        return False

    @abstractmethod
    def place(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a complete segment of encoded frames."""

    @abstractmethod
    def answers(self) -> Floats:
        """Return the neurons' cosines where the input lies right on each unit of the second map, (units, actions)."""


class PyramidAnatomy(Anatomy):
    """The maps of the default recogniser."""

    figure = WHOLE

    def __init__(self, model: PyramidModel) -> None:
        self.model: PyramidModel = model
        self.postures, self.actions = model.first.postures, model.concepts.layout

    def unit_points(self) -> Floats:
        """Return the joints that each unit of the first map stands for, relative to the torso, (units, 15, 3)."""
        return self.postures.weights.reshape(len(self.postures.weights), -1, 3)

    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the first map's winner at each encoded frame."""
        return self.model.winners(frames)

    def in_mirror(self, frames: Sequence[Frame]) -> bool:
        """Tell whether a segment of encoded frames is read as its mirror image."""
        return self.model.reads_in_mirror([frame.code for frame in frames])

    def place(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a complete segment of encoded frames."""
        scores = self.model.scores([frame.code for frame in frames], complete_weights(self.model, frames))
        return self.actions.bmu(scores)

    def answers(self) -> Floats:
        """Return the neurons' cosines where the input lies right on each unit of the second map, (units, actions)."""
        heard = [self.model.concepts.activity(weights) for weights in self.actions.weights]
        return np.stack([self.model.layer3.cosines(activities) for activities in heard])


class PaperAnatomy(Anatomy):
    """The maps of the paper's recogniser."""

    figure = LIMB

    def __init__(self, model: PaperModel) -> None:
        self.model: PaperModel = model
        self.postures, self.actions = model.layer1, model.layer2

    def unit_points(self) -> Floats:
        """Return the three joints that each unit of the first map stands for, relative to the torso, (units, 3, 3)."""
        above_hips_m = STANDING[INDEX["torso"]] - STANDING[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0)
        points: Floats = self.postures.weights.reshape(len(self.postures.weights), -1, 3) - above_hips_m
        return points

    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the winner for the part attended to at each encoded frame, UNSEEN where that part has no joint."""
        cells = np.array([frame.code for frame in frames])
        motion = np.array([frame.motion for frame in frames])
        seen: Indices = cells[:, attended(motion, self.model.description.part, (cells != UNSEEN).any(axis=0))]
        return seen

    def place(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a segment of encoded frames."""
        winners = self.winners(frames)
        trace = self.postures.coordinates[without_repeats(winners[winners != UNSEEN])]
        return self.actions.bmu(ordered_vector(trace, self.model.description.points))

    def answers(self) -> Floats:
        """Return the neurons' cosines where the input lies right on each unit of the second map, (units, actions)."""
        contrast = self.model.description.contrast
        heard = [activity(self.actions.excess2(weights), contrast) for weights in self.actions.weights]
        return np.stack([self.model.layer3.cosines(activities) for activities in heard])


def anatomy_of(model: Model) -> Anatomy:
    """Find a model's maps.

    Raises:
        TypeError: it is of a kind that has no pictures yet.
    """
    match model:
        case PyramidModel():
            return PyramidAnatomy(model)
        case PaperModel():
            return PaperAnatomy(model)
        case _:
            raise TypeError(f"no pictures of a model of kind {model.about.kind!r}")


def complete_weights(model: PyramidModel, frames: Sequence[Frame]) -> Sequence[float]:
    """Return the weights of the discriminant axes' stages at the end of a segment."""
    return model.stages.weights((frames[-1].stamp_ns - frames[0].stamp_ns) / SECOND_NS, complete=True)
