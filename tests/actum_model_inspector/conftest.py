"""Small models of each kind and what they say about recordings of synthetic people."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from actum.messages import Segment, Skeleton
from actum.recorder import write_recording
from actum.recording import Recording
from actum_model_inspector.answered import AnsweredSegment, answered_segments
from performers import HAND_PATHS, TINY_OF_EACH_KIND, performance
from recognisers import tiny_model
from som_classifier.model_maps import ModelMaps, maps_of
from som_classifier.pyramid_model import PyramidModel

Record = Callable[..., Recording]


@pytest.fixture
def record(tmp_path: Path) -> Record:
    """Write messages to a file of the test's folder and open it."""

    def write(skeletons: Sequence[Skeleton], marks: Sequence[Segment], person: str = "2") -> Recording:
        path = tmp_path / "performance.mcap"
        write_recording(path, [*skeletons, *marks], person=person, source="test")
        return Recording(path)

    return write


@pytest.fixture(params=TINY_OF_EACH_KIND, ids=lambda preset: preset.name)
def maps(request: pytest.FixtureRequest) -> ModelMaps:
    maps = maps_of(tiny_model(request.param))
    assert maps is not None
    return maps


@pytest.fixture
def pyramid() -> PyramidModel:
    model = tiny_model()
    assert isinstance(model, PyramidModel)
    return model


@pytest.fixture
def recording(record: Record) -> Recording:
    """Somebody who was not in training does every action once."""
    return record(*performance([*HAND_PATHS], height=1.1, seed=5))


@pytest.fixture
def segments(maps: ModelMaps, recording: Recording) -> list[AnsweredSegment]:
    return answered_segments(maps.model, [recording])
