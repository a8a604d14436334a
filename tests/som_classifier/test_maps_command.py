"""The classifier describes its model's maps, whatever model it has."""

import numpy as np
import pytest
from numpy.typing import NDArray

from actum.commands import Refusal
from recognisers import tiny_model
from som_classifier.frames import Frame
from som_classifier.model import Arrays, Model, Recognition
from som_classifier.node import SomClassifier


class Encoding:
    def encode(self, frame: Frame) -> Frame:
        return frame


class Foreign(Model):
    """A recogniser of another kind, which has no maps."""

    def __init__(self) -> None:
        self.metadata = tiny_model().metadata.model_copy(update={"kind": "foreign"})

    @property
    def arrays(self) -> Arrays:
        return {}

    @classmethod
    def restored(cls, metadata: str, arrays: Arrays) -> Model:
        return cls()

    def encoder(self) -> Encoding:
        return Encoding()

    def recognise(self, frames: list[Frame], complete: bool) -> Recognition:  # type: ignore[override]
        raise NotImplementedError

    def trace(self, frames: list[Frame]) -> NDArray[np.float64]:  # type: ignore[override]
        return np.zeros((0, 2))

    def maps(self, frames: list[Frame]) -> Arrays:  # type: ignore[override]
        return {}


def maps_of(model: Model | None) -> dict[str, object]:
    commands = {command.name: command for command in SomClassifier(model).commands}
    return commands["maps"].obey({})


def test_maps_are_described() -> None:
    described = maps_of(tiny_model())
    assert described["posture_map"] and described["action_map"]


def test_without_a_model_there_are_none() -> None:
    assert maps_of(None) == {"model": None, "posture_map": None, "action_map": None}


def test_of_a_model_of_a_kind_without_maps_it_refuses_to_describe_any() -> None:
    with pytest.raises(Refusal, match="the model has no maps: models of kind 'foreign' contain none"):
        maps_of(Foreign())
