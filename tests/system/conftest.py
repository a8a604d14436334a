from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from actum.recording import Recording
from actum.runtime import Client
from actum_command.scene_marks import write_examples
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train
from deployments import Deployed, deployed
from live import System, system
from models import QUICK
from third_session import Third


@pytest.fixture
def running(tmp_path: Path) -> Iterator[System]:
    with system(tmp_path) as made:
        yield made


@pytest.fixture
def client(running: System) -> Iterator[Client]:
    running.start_router()
    with running.client() as made:
        yield made


@pytest.fixture(scope="module")
def deployment(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Deployed]:
    with deployed(tmp_path_factory.mktemp("deployment"), passwords=True) as made:
        yield made


@pytest.fixture
def third(deployment: Deployed) -> Iterator[Third]:
    with closing(Third(deployment)) as made:
        yield made


@pytest.fixture(scope="session")
def scene_model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model of the simulated scene."""
    folder = tmp_path_factory.mktemp("scene-model")
    write_examples(folder / "examples.mcap", repetitions=4, actor=0, seed=1)
    model = train(samples_from([Recording(folder / "examples.mcap")]).usable, QUICK)
    model.save(folder / "model.npz")
    return folder / "model.npz"
