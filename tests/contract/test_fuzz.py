"""A share of `make fuzz`: real messages with anything wrong, and hostile ones, at every service."""

import pytest

from fuzzing.campaign import run
from fuzzing.targets import TARGETS

SHARE = 1500
SEEDS = (11, 12)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("service", TARGETS)
def test_hostile_messages_are_counted_and_survived(service: str, seed: int) -> None:
    outcome = run(service, SHARE, seed)
    assert outcome.messages == SHARE
    assert outcome.rejects > SHARE // 3
    assert outcome.flat
