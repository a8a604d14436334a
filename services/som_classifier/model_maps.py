"""The maps of every kind of model behind one interface: map of postures, map of actions, and segments' winners."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel

from actum.arrays import Floats, Indices
from actum.som import Som
from som_classifier.attention import ALL
from som_classifier.frames import Frame
from som_classifier.map_activity import soft_activity
from som_classifier.model import Model
from som_classifier.paper_model import PaperModel
from som_classifier.pyramid_model import PyramidModel

TORSO_FROM_HIPS_M = np.array([0.0, 0.24, 0.0])
"""The torso relative to the hips' middle of somebody who stands, (3,): metres to the left, up and forward."""


class NoMapsError(ValueError):
    """A model of a kind without maps."""

    def __init__(self, model: Model) -> None:
        super().__init__(f"the model has no maps: models of kind {model.metadata.kind!r} contain none")


class ModelMaps(ABC):
    """The maps of one model.

    Attributes:
        model: the model that the maps belong to.
        postures: the first map.
        actions: the second map.
        shows_bodies: whether a unit of the first map stands for all joints; else it does for those of one limb.
        velocities: the map of velocities, None where the model has none.
        arms: the map of arms, None where the model has none.
        mirrors: whether an action of the left arm is read as its mirror image.
    """

    model: Model
    postures: Som
    actions: Som
    shows_bodies: bool
    velocities: Som | None = None
    arms: Som | None = None
    mirrors = False

    @abstractmethod
    def unit_joints(self) -> Floats:
        """Return the joints that each unit of the first map stands for, metres from the torso, (units, joints, 3)."""

    @abstractmethod
    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the first map's winner at each encoded frame, NO_WINNER where it has none, shape (n,)."""

    def is_mirrored(self, frames: Sequence[Frame]) -> bool:
        """Tell whether a segment of encoded frames is read as its mirror image."""
        return False

    @abstractmethod
    def action_unit(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a complete segment of encoded frames."""

    @abstractmethod
    def unit_cosines(self) -> Floats:
        """Return the neurons' cosines for the weights of each unit of the second map as input, (units, actions)."""


class PyramidMaps(ModelMaps):
    """The maps of the default recogniser."""

    shows_bodies = True

    def __init__(self, model: PyramidModel) -> None:
        self.model: PyramidModel = model
        self.postures, self.actions = model.first.postures, model.action_map.som
        self.velocities, self.arms = model.first.maps["velocities"], model.first.maps["arms"]
        self.mirrors = model.metadata.mirrors

    def unit_joints(self) -> Floats:
        """Return the joints that each unit of the first map stands for, metres from the torso, (units, 15, 3)."""
        return self.postures.weights.reshape(len(self.postures.weights), -1, 3)

    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the first map's winner at each encoded frame."""
        return self.model.winners(frames)

    def is_mirrored(self, frames: Sequence[Frame]) -> bool:
        """Tell whether a segment of encoded frames is read as its mirror image."""
        return self.model.reads_in_mirror([frame.activity for frame in frames])

    def action_unit(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a complete segment of encoded frames."""
        return self.model.action_unit(frames)

    def unit_cosines(self) -> Floats:
        """Return the neurons' cosines for the weights of each unit of the second map as input, (units, actions)."""
        activities = [self.model.action_map.activity(weights) for weights in self.actions.weights]
        return np.stack([self.model.layer3.cosines(activity) for activity in activities])


class PaperMaps(ModelMaps):
    """The maps of the paper's recogniser."""

    def __init__(self, model: PaperModel) -> None:
        self.model: PaperModel = model
        self.postures, self.actions = model.layer1, model.layer2
        self.shows_bodies = model.metadata.posture.attention == ALL

    def unit_joints(self) -> Floats:
        """Return the joints that each unit of the first map stands for, metres from the torso, (units, 3 or 15, 3)."""
        points: Floats = self.postures.weights.reshape(len(self.postures.weights), -1, 3)
        from_hips = self.model.metadata.posture.origin == "hips"
        return points - TORSO_FROM_HIPS_M if from_hips else points

    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the winner for the attended part at each encoded frame, NO_WINNER where all of the part is missing."""
        _, activity = self.model.attended(frames)
        return activity.winners

    def action_unit(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a segment of encoded frames."""
        return self.model.action_unit(frames)

    def unit_cosines(self) -> Floats:
        """Return the neurons' cosines for the weights of each unit of the second map as input, (units, actions)."""
        contrast = self.model.metadata.contrast
        activities = [soft_activity(self.actions.excess2(weights), contrast) for weights in self.actions.weights]
        return np.stack([self.model.layer3.cosines(activity) for activity in activities])


MAPS: dict[str, Callable[[Any], ModelMaps]] = {"paper": PaperMaps, "pyramid": PyramidMaps}
"""The maps of each kind of model that has any, see `som_classifier.model_loading.KINDS`."""


def maps_of(model: Model) -> ModelMaps | None:
    """Return a model's maps, None where its kind has none."""
    make = MAPS.get(model.metadata.kind)
    return None if make is None else make(model)


DIGITS = 3
"""Of a joint's coordinates: millimetres."""
Body = list[tuple[float, float, float]]


class PostureMap(BaseModel):
    """The first map: like postures lie side by side."""

    rows: int
    """Units in a column."""
    columns: int
    """Units in a row."""
    bodies: list[Body] | None
    """The fifteen joints that each unit stands for, row by row: metres to the left, up and forward from the torso; null
    where units stand for one limb."""


class ActionMap(BaseModel):
    """The second map: each action has regions of its own."""

    rows: int
    """Units in a column."""
    columns: int
    """Units in a row."""
    labels: list[str]
    """The action whose neuron answers each unit most, row by row."""


class MapDescription(BaseModel):
    """The maps of the model that is in use."""

    model: str | None
    """The model's id; null where there is none, and then no maps."""
    posture_map: PostureMap | None = None
    """The map of postures."""
    action_map: ActionMap | None = None
    """The map of actions."""


def map_description(model: Model | None) -> MapDescription:
    """Describe a model's maps.

    Raises:
        NoMapsError: it is of a kind without maps.
    """
    if model is None:
        return MapDescription(model=None)
    maps = maps_of(model)
    if maps is None:
        raise NoMapsError(model)
    postures, actions = maps.postures, maps.actions
    bodies = maps.unit_joints().round(DIGITS).tolist() if maps.shows_bodies else None
    labels = [model.labels[index] for index in maps.unit_cosines().argmax(axis=1)]
    return MapDescription(
        model=model.id,
        posture_map=PostureMap(rows=postures.rows, columns=postures.cols, bodies=bodies),
        action_map=ActionMap(rows=actions.rows, columns=actions.cols, labels=labels),
    )
