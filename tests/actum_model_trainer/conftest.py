"""Recordings of synthetic people, written into the test's folder."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from actum.messages import Segment, Skeleton
from actum.recorder import write_recording
from actum.recording import Recording
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample
from performers import HAND_PATHS, performance

Record = Callable[..., Recording]


def written(folder: Path, name: str, *messages: Skeleton | Segment, person: str = "1", **fields: str) -> Recording:
    path = folder / f"{name}.mcap"
    write_recording(path, messages, person=person, source="test", **fields)
    return Recording(path)


@pytest.fixture
def record(tmp_path: Path) -> Record:
    """Write messages to a file of the test's folder and open it."""
    return partial(written, tmp_path)


@pytest.fixture(scope="session")
def three_people(tmp_path_factory: pytest.TempPathFactory) -> list[Recording]:
    """Three people of different height, each doing every action twice."""
    folder, recordings = tmp_path_factory.mktemp("people"), []
    for person, height in enumerate((0.9, 1.0, 1.15), start=1):
        skeletons, marks = performance([*HAND_PATHS] * 2, height, seed=person)
        recordings.append(written(folder, f"person{person}", *skeletons, *marks, person=str(person)))
    return recordings


@pytest.fixture(scope="session")
def samples(three_people: list[Recording]) -> list[SegmentSample]:
    return samples_from(three_people).usable
