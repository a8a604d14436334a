"""Runs a front: a node that people also reach by another way than Zenoh, such as a page in their browsers."""

import threading
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Protocol

import zenoh

from actum.node import Node
from actum.runtime.client import Client
from actum.runtime.outbox import Outbox
from actum.runtime.serving import S, configured, live
from actum.runtime.step_service import NodeService
from actum.settings import ServiceSettings


class Front(Node, Protocol):
    """A node with a server of its own, which runs also while there is no router."""

    def serving(self) -> AbstractContextManager[None]:
        """Serve people until the context is left."""
        ...

    def attach(self, client: Client | None) -> None:
        """Take the session by which people's wishes go to other services; None where there is none any more."""
        ...

    @property
    def working(self) -> bool:
        """Whether people are served."""
        ...


def run_front(settings_type: type[S], build: Callable[[S], Front]) -> None:
    """Run a front as this process's service until SIGTERM or SIGINT."""
    settings, front = configured(settings_type, build)
    live(FrontService(front, settings), settings, front.serving)


class FrontService(NodeService):
    """Runs a front: gives it messages as any node gets them, and the session to put and ask by."""

    def __init__(self, front: Front, settings: ServiceSettings) -> None:
        super().__init__(front, settings)
        self._front = front

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        self._front.attach(Client(self._settings, session=session))
        try:
            super()._work(session, outbox, stop, vacant_s)
        finally:
            self._front.attach(None)

    def _healthy(self) -> bool:
        return super()._healthy() and self._front.working
