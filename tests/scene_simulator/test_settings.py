"""The settings of the simulated scene, given as flags or by the environment."""

from collections.abc import Iterator
from itertools import islice, pairwise

import pytest
from pydantic import ValidationError

from actum.messages import Skeleton, Truth
from scene_simulator.endless_simulator import simulator_of
from scene_simulator.settings import Settings


@pytest.mark.parametrize("rate", ["0", "5", "10", "15", "30"])
def test_the_image_rate_is_read_from_text(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_IMAGE_HZ", rate)
    assert Settings().image_hz == int(rate)


@pytest.mark.parametrize("rate", ["7", "", "-5", "fast"])
def test_other_rates_are_refused(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_IMAGE_HZ", rate)
    with pytest.raises(ValidationError, match="image_hz"):
        Settings()


@pytest.mark.parametrize(
    ("chosen", "agents", "has_truth"),
    [
        ({}, 1, True),
        ({"everyday": "all"}, 1, True),
        ({"everyday": "only"}, 1, False),
        ({"everyday": "familiar", "actors": 4}, 4, True),
    ],
)
def test_doings_and_people_of_a_scene_are_chosen_by_settings(chosen: dict, agents: int, has_truth: bool) -> None:
    settings = Settings(image_hz=0, repetitions=1, minutes=1.0, **chosen)
    messages = [message for frame in simulator_of(settings, start_ns=0).frames() for message in frame]
    skeletons = [message for message in messages if isinstance(message, Skeleton)]

    assert len(skeletons[0].agents) == agents
    assert any(isinstance(message, Truth) for message in messages) == has_truth
    assert len(skeletons) >= 60 * 30 or not chosen


@pytest.mark.parametrize("repetitions", [0, 1])
@pytest.mark.parametrize("actors", [1, 2])
@pytest.mark.parametrize("driven", [False, True])
def test_a_scene_that_is_started_anew_is_another_session(repetitions: int, actors: int, driven: bool) -> None:
    settings = Settings(image_hz=0, repetitions=repetitions, actors=actors, driven=driven and actors == 1)
    sessions = {next(_skeletons(settings, start_ns)).session_id for start_ns in (10**18, 2 * 10**18)}
    assert len(sessions) == 2


def _skeletons(settings: Settings, start_ns: int) -> Iterator[Skeleton]:
    frames = simulator_of(settings, start_ns).frames()
    return (message for frame in frames for message in frame if isinstance(message, Skeleton))


def test_everyday_doings_without_an_end_go_on_in_one_stream_of_rising_stamps() -> None:
    endless = simulator_of(Settings(image_hz=0, everyday="only", minutes=0.2), start_ns=0)
    stamps_ns = [messages[-1].stamp_ns for messages in islice(endless.frames(), 2 * 60 * 30)]

    assert all(before < after for before, after in pairwise(stamps_ns))
