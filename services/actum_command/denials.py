"""Whether a router's access control keeps this program from seeing what runs, told apart from that nothing runs."""

from collections.abc import Iterable, Iterator
from typing import Protocol

from actum_command.heard import Heard

ROLE = "show it the folder of a role that may look, such as viewer, in ACTUM_CREDENTIALS"
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
        return f"services run, and the router's access control tells this program nothing of them: {ROLE}"
    if client.router_tells():
        return None
    return (
        "the router lets this program in and tells it nothing, not even of itself: its access control denies this "
        f"program everything, unless no service runs and the router is to keep silent. To be told, {ROLE}"
    )


def partly_denied(heard: Heard) -> Iterator[str]:
    """Yield what is missing of services that are known otherwise."""
    answering = {answer.info.service for answer in heard.answers}
    running = heard.tokens.keys() | heard.statuses.keys() | answering
    for what, known in (("that it is alive", heard.tokens.keys()), ("what it is", answering)):
        if running and not known:
            yield f"no service tells {what}, though some run: the router's access control denies it; {ROLE}"
    if heard.tokens and not heard.statuses:
        yield f"no service's status comes through: the router's access control denies it, or all hang; {ROLE}"
