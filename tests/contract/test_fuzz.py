"""A share of `make fuzz`: real messages with anything wrong, and hostile ones, at every service."""

import pytest

from fuzzing.campaign import run
from fuzzing.targets import TARGETS

SHARE = 500
SEED = 11


@pytest.mark.thorough
@pytest.mark.parametrize("service", TARGETS)
def test_hostile_messages_are_counted_and_survived(service: str) -> None:
    outcome = run(service, SHARE, SEED)
    assert outcome.messages == SHARE
    assert outcome.rejects > SHARE // 3
    assert outcome.flat
