"""The option that approves what is given now, and the fixture that compares."""

from functools import partial

import pytest

from approving import Approve, check


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--approve", action="store_true", help="write the approved values anew")


@pytest.fixture
def approve(request: pytest.FixtureRequest) -> Approve:
    """Compare a value with the approved file of a name: `approve(name, value, tolerance)`."""
    return partial(check, renew=bool(request.config.getoption("--approve", False)))
