"""A gateway that is told how its camera is tilted puts it in every skeleton."""

import pytest
from pydantic import ValidationError

from actum.messages import Image, Skeleton
from sensor_gateway.settings import Settings
from sensor_gateway.sources import source_of

UP = [0.0, -0.97, 0.24]


def first_messages(**told: object) -> list[Skeleton | Image]:
    source = source_of(Settings(repetitions=1, **told), start_ns=0)  # type: ignore[arg-type]
    return next(messages for messages in source.frames() if any(isinstance(m, Image) for m in messages))  # type: ignore[return-value]


def test_each_skeleton_says_which_way_is_up() -> None:
    told = first_messages(up_in_camera=UP)
    assert [m.up_in_camera for m in told if isinstance(m, Skeleton)] == [UP]
    assert any(isinstance(m, Image) for m in told)


def test_it_reads_it_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_UP_IN_CAMERA", "[0, -0.97, 0.24]")
    assert Settings().up_in_camera == UP


def test_nothing_is_said_where_nothing_is_known() -> None:
    assert [m.up_in_camera for m in first_messages() if isinstance(m, Skeleton)] == [None]


@pytest.mark.parametrize("up", [[0, 0, 0], [0, 1e9, 0], [0, -1]])
def test_up_must_be_a_direction(up: list[float]) -> None:
    with pytest.raises(ValidationError, match="up_in_camera"):
        Settings(up_in_camera=up)
