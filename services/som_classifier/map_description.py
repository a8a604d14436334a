"""What a model's two maps stand for, as plain values: a body for each posture, an action for each place."""

from pydantic import BaseModel

from som_classifier.model import Model
from som_classifier.model_maps import NoMapsError, maps_of

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
