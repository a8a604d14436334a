"""Whether a router's access control keeps this program from seeing what runs, told apart from that nothing runs."""

from collections.abc import Iterable, Iterator
from typing import Protocol

from actum_command.heard import Heard

ROLE = "set ACTUM_CREDENTIALS to the credentials folder of a role that may read messages, such as viewer"
"""What to do."""


class Asking(Protocol):
    """The questions that tell it; `actum.runtime.Client` answers them."""

    def router_tells(self) -> bool:
        """Tell whether the router describes itself."""
        ...

    def offers(self, service: str) -> bool:
        """Tell whether the router knows of such a service that would answer."""
        ...


def everything_denied(heard: Heard, client: Asking, expected: Iterable[str]) -> str | None:
    """Return what access control hides where nothing at all was heard; None where nothing is hidden, or cannot be."""
    if heard.tokens or heard.answers or heard.statuses:
        return None
    if any(client.offers(service) for service in expected):
        return (
            "services run, but the router's access control denies this program permission to read what they publish: "
            f"{ROLE}"
        )
    if client.router_tells():
        return None
    return (
        "the router lets this program connect but answers none of its queries: either no service runs, or the router's "
        f"access control denies this program permission to read anything. If services should be running, {ROLE}"
    )


def partly_denied(heard: Heard) -> Iterator[str]:
    """Yield what is missing of services that are known otherwise."""
    answering = {answer.info.service for answer in heard.answers}
    running = heard.tokens.keys() | heard.statuses.keys() | answering
    for what, known in (("their liveliness tokens", heard.tokens.keys()), ("their info keys", answering)):
        if running and not known:
            yield f"services run, but the router's access control denies this program permission to read {what}: {ROLE}"
    if heard.tokens and not heard.statuses:
        yield (
            "services run, but none of their status messages arrives. Either all services hang: restart the services. "
            f"Or the router's access control denies this program permission to read status messages: {ROLE}"
        )
