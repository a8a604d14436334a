"""A seeded scene: an actor at a table does five actions on three marked objects before a simulated camera."""

from sensor_gateway.simulator.conditions import PLAIN, Conditions, load_conditions
from sensor_gateway.simulator.programme import ACTIONS, NO_OBJECT, Sample, balanced_programme
from sensor_gateway.simulator.scene import Scene, SceneState
from sensor_gateway.simulator.source import Simulator, labelled_stream

__all__ = [
    "ACTIONS",
    "NO_OBJECT",
    "PLAIN",
    "Conditions",
    "Sample",
    "Scene",
    "SceneState",
    "Simulator",
    "balanced_programme",
    "labelled_stream",
    "load_conditions",
]
