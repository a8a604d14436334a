from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from actum.runtime import Client
from actum_command.simulated_model import SIMULATED_MODEL
from deployments import Deployed, deployed
from live import System, system
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
def scene_model() -> Path:
    return SIMULATED_MODEL
