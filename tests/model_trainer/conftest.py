"""Recordings of synthetic people, written into the test's folder."""

from collections.abc import Callable
from pathlib import Path

import pytest

from actum.messages import Segment, Skeleton
from actum.recording import Recorder, Recording
from performers import HAND_PATHS, performance

Record = Callable[..., Recording]


@pytest.fixture
def record(tmp_path: Path) -> Record:
    """Write messages to a file of the test's folder and open it."""

    def write(name: str, *messages: Skeleton | Segment, person: str = "1", **fields: str) -> Recording:
        path = tmp_path / f"{name}.mcap"
        with Recorder(path, person=person, source="test", **fields) as recorder:
            for message in messages:
                recorder.write(message)
        return Recording(path)

    return write


@pytest.fixture
def three_people(record: Record) -> list[Recording]:
    """Three people of different height, each doing every action twice."""
    recordings = []
    for person, height in enumerate((0.9, 1.0, 1.15), start=1):
        skeletons, marks = performance([*HAND_PATHS] * 2, height, seed=person)
        recordings.append(record(f"person{person}", *skeletons, *marks, person=str(person)))
    return recordings
