"""How long a candidate looks for others before it serves."""

from collections.abc import Sequence

import pytest

from actum.keys import Claim
from actum.runtime.place import LOST_S, RETURNING_S, Alone

OTHER = [Claim("candidate", "other", "1")]


def looked(looks: Sequence[tuple[float, Sequence[Claim] | None]], connected: bool = True) -> float | None:
    """Return when a candidate that settles for a quarter of a second was alone for long enough."""
    alone = Alone(settling_s=0.25)
    return next((at_s for at_s, others in looks if alone.for_long(others, connected, at_s)), None)


def every_tenth(
    others: Sequence[Claim] | None, begin_s: float, end_s: float
) -> list[tuple[float, Sequence[Claim] | None]]:
    return [(tenth / 10, others) for tenth in range(round(10 * begin_s), round(10 * end_s))]


def test_who_sees_nobody_for_a_while_is_alone() -> None:
    assert looked(every_tenth([], 1, 5)) == pytest.approx(1.3)


def test_while_another_is_there_nobody_is_alone_and_then_waits_anew() -> None:
    assert looked([(0.9, []), *every_tenth(OTHER, 1, 2), *every_tenth([], 2, 5)]) == pytest.approx(2.3)


def test_after_the_router_was_lost_others_have_time_to_return() -> None:
    lost = every_tenth(None, 1, 2)
    assert looked([*lost, *every_tenth([], 2, 5)], connected=False) == pytest.approx(2 + RETURNING_S)


def test_a_router_that_is_lost_is_waited_for_without_end() -> None:
    assert looked(every_tenth(None, 1, 100), connected=False) is None


def test_a_router_that_never_answers_such_questions_is_no_obstacle(caplog: pytest.LogCaptureFixture) -> None:
    assert looked(every_tenth(None, 1, 100)) == pytest.approx(1 + LOST_S)
    assert "liveliness_query" in caplog.text
