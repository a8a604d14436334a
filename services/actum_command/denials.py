"""Whether a router's access control keeps this program from seeing what runs, told apart from that nothing runs."""

from collections.abc import Iterable, Iterator
from typing import Protocol

from actum_command.heard import Heard

ROLE = "set ACTUM_CREDENTIALS to the folder of a role that may read, such as viewer"
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
            "services run, but the router's access control denies this program permission to read their messages: "
            f"{ROLE}"
        )
    if client.router_tells():
        return None
    return (
        "the router accepts this program but answers no query: its access control denies this program all "
        f"reading, or no service runs. If services should run, {ROLE}"
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
            "services run, but no status arrives: either all services hang (restart them), or the router's access "
            f"control denies this program permission to read their status ({ROLE})"
        )
