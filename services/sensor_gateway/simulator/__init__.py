"""A seeded scene: an actor at a table does five actions on three marked objects before a simulated camera."""

from sensor_gateway.simulator.programme import ACTIONS, Sample, balanced_programme
from sensor_gateway.simulator.scene import Scene, SceneState
from sensor_gateway.simulator.source import Simulator, labelled_stream

__all__ = ["ACTIONS", "Sample", "Scene", "SceneState", "Simulator", "balanced_programme", "labelled_stream"]
