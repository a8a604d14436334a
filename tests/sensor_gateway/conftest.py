"""A recording of the simulated scene, for what the gateway adds to any source."""

from itertools import islice
from pathlib import Path

import pytest

from actum.recorder import Recorder
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator

FRAMES = 40


@pytest.fixture(scope="session")
def recorded_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first frames of the scene, with its images."""
    path = tmp_path_factory.mktemp("scene") / "scene.mcap"
    with Recorder(path, person="simulated 0", source="simulator") as recorder:
        for messages in islice(Simulator(balanced_programme(1, 1, 0), 0, 1).frames(), FRAMES):
            for message in messages:
                recorder.write(message)
    return path
