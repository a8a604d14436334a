"""A program asks the services of a sensor who they are: some answers may be none."""

from collections.abc import Iterator

import pytest
import zenoh

from actum import keys
from actum.codec import encode
from actum.messages import Info
from actum.runtime import Client
from actum.runtime.session import client_config
from live import System, wait_until

pytestmark = pytest.mark.system

SERVICE = Info(
    stamp_ns=0, seq=1, sensor="kinect0", service="good", instance="one", version="1", schemas=[], joint_names=[]
)


@pytest.fixture
def beside(running: System, client: Client) -> Iterator[zenoh.Session]:
    """Another program on the same router."""
    with zenoh.open(client_config(running.settings)) as session:
        yield session


def info_key(service: str) -> str:
    return keys.key(keys.INFO, "kinect0", service)


def test_only_answers_that_say_what_a_service_is_count(client: Client, beside: zenoh.Session) -> None:
    """One refuses, one sends bytes that are no message, one says what it is."""
    info = encode(SERVICE)
    asked = set()

    def answering(query: zenoh.Query) -> None:
        with query:
            query.reply(info.key, info.payload, encoding=info.encoding)

    def refusing(query: zenoh.Query) -> None:
        with query:
            asked.add("refusing")
            query.reply_err(b"not for you")

    def babbling(query: zenoh.Query) -> None:
        with query:
            asked.add("babbling")
            query.reply(info_key("babbling"), b"no message")

    answers = {"good": answering, "refusing": refusing, "babbling": babbling}
    declared = [beside.declare_queryable(info_key(name), answer) for name, answer in answers.items()]
    wait_until(lambda: client.infos() == [SERVICE] and len(asked) == 2, "all are asked, and one is known")
    for queryable in declared:
        queryable.undeclare()
    wait_until(lambda: client.infos() == [], "nobody answers any more")


def test_tokens_are_those_of_the_sensor_in_their_order(client: Client, beside: zenoh.Session) -> None:
    assert client.alive() == []
    expected = [keys.alive("kinect0", service, "one") for service in ("a", "b")]
    held = [beside.liveliness().declare_token(key) for key in [*reversed(expected), keys.alive("other", "a", "one")]]
    wait_until(lambda: client.alive() == expected, "both are alive")
    for token in held:
        token.undeclare()
    wait_until(lambda: client.alive() == [], "both are gone")
