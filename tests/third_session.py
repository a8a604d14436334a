"""Somebody who takes no part in what a test tries with a deployment's routers, and tells what became of it."""

import time

import zenoh

from actum import keys
from actum.runtime import Listening
from actum_deployer.roles import ROLES
from deployments import Deployed
from empty_messages import skeleton
from live import PATIENCE_S, wait_until

SERVICE_OF = {role.name: service for role in ROLES for service in role.services}


def passed_on(session: zenoh.Session, who: str) -> None:
    """Wait until the session's router has taken what was put before: it ends a query, that the role may ask, later."""
    service = SERVICE_OF.get(who.partition(".")[0])
    asked = keys.key(keys.INFO, "kinect0", service) if service else keys.pattern(keys.INFO)
    asked_s = time.monotonic()
    for _ in session.get(asked, timeout=PATIENCE_S):  # a session's own answers are no concern of the router
        pass
    assert time.monotonic() < asked_s + PATIENCE_S, "the query was denied"


def received(listening: Listening) -> list[str]:
    taken = []
    while (each := listening.receive()) is not None:
        taken.append(each.key)
    return taken


class Third:
    """Somebody who receives everything, on both hosts, and sees what a gateway puts after what is tried."""

    def __init__(self, deployment: Deployed) -> None:
        self.clients = [deployment.client("recorder", host) for host in ("camera", "compute")]
        self.heard = [client.listen(keys.everything()) for client in self.clients]
        self._gateway = deployment.client("gateway.kinect0", "camera")
        self._number = 0
        self.until_told()

    def until_told(self) -> list[str]:
        """Return the keys of what came to either host before a skeleton that is put now; once it came to both."""
        assert self._gateway.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
        self._number += 1
        came: list[list[str]] = [[], []]
        last = keys.key(keys.SKELETON, "kinect0")

        def told() -> bool:
            for at_host, listening in zip(came, self.heard, strict=True):
                at_host.extend(received(listening))
            if all(last in at_host for at_host in came):
                return True
            self._gateway.put(skeleton(self._number))
            return False

        wait_until(told, "a third session receives what a gateway puts")
        return [key for at_host in came for key in at_host if key != last]

    def hears(self, key: str) -> None:
        """Wait until only a key's messages came to both hosts, since what was put before."""
        came: list[str] = []
        wait_until(lambda: came.extend(self.until_told()) or len(came) >= 2, f"{key} is heard on both hosts")
        assert set(came) == {key}

    def close(self) -> None:
        for client in (*self.clients, self._gateway):
            client.__exit__()
