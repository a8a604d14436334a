"""Which topics of people are published now, and the payloads on them."""

from collections.abc import Iterable, Iterator
from itertools import count
from typing import Any

from actum.bridge import Foreign, ForeignTopic, Withdrawn
from ros2_bridge.message_types import to_cdr
from ros2_bridge.settings import Settings
from ros2_bridge.topics import RosTopic, published

FIRST_NUMBER = 1000
"""The number of the first of these topics in its token, far above those of the topics that stay."""


class Announcing:
    """Announces the chosen ones of people's topics, and makes payloads only for these."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._session_id = ""
        self._numbers = count(FIRST_NUMBER)
        self._announced: set[str] = set()

    def begin(self, session_id: str, lasting: Iterable[ForeignTopic]) -> None:
        """Begin anew in a Zenoh session in which the lasting topics are published."""
        self._session_id = session_id
        self._announced = {topic.name for topic in lasting}

    def announce(self, topics: Iterable[RosTopic]) -> Iterator[ForeignTopic]:
        """Yield the chosen topics as they are to be published from now on."""
        for topic in topics:
            if topic.chosen_by in self._settings.chosen_topics and topic.name not in self._announced:
                self._announced.add(topic.name)
                yield published(topic, self._settings, self._session_id, next(self._numbers))

    def withdraw(self, topics: Iterable[RosTopic]) -> Iterator[Withdrawn]:
        """Yield the topics that are to be published no longer."""
        for topic in topics:
            if topic.name in self._announced:
                self._announced.remove(topic.name)
                yield Withdrawn(topic.name)

    def on(self, name: str, message: Any | None) -> Iterator[Foreign]:
        """Yield the payload of a message, none where its topic is not published or there is no message."""
        if message is not None and name in self._announced:
            yield Foreign(name, to_cdr(message))
