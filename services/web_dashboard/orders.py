"""What browsers want done: marks, and commands of services. Each is answered, under the number it came with."""

import asyncio
import json
import logging
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from actum import keys
from actum.commands import Refusal, problems
from actum.limits import MOST_OPEN_SEGMENTS
from actum.messages import MANUAL, Segment
from actum.runtime import Client, NotAnsweredError
from web_dashboard.encoding import text

log = logging.getLogger("actum")

LONGEST_ORDER_BYTES = 1_000_000
"""Bytes of one message from a browser; a video comes in parts of half of that."""
CLASSIFIER_S = 2.0
"""How long (s) a mark waits for a classifier that is starting to listen."""
AT_ONCE = 8
"""Commands that wait for services' answers at the same time, of all browsers."""
OURS = frozenset({"self", "service", "command", "timeout_s"})
"""Names that `Client.ask` has taken for itself."""
NO_ROUTER = (
    "the page is not connected to a router: start a router with 'actum router', or the whole system with 'actum up'"
)

Chunk = Annotated[str, Field(pattern=f"^{keys.CHUNK.pattern}$")]


class Ask(BaseModel):
    """A command of a service, with its fields."""

    model_config = ConfigDict(extra="forbid")
    service: Chunk
    command: Chunk
    fields: dict[str, Any] = {}

    @field_validator("fields")
    @classmethod
    def _check_names(cls, fields: dict[str, Any]) -> dict[str, Any]:
        if taken := fields.keys() & OURS:
            raise ValueError(
                f"a command cannot have the fields {', '.join(sorted(taken))}, because these names are reserved: "
                "leave out these fields"
            )
        return fields


class Mark(BaseModel):
    """A start or end mark of the switch."""

    model_config = ConfigDict(extra="forbid")
    kind: Literal["start", "end"]
    segment_id: Annotated[str, Field(min_length=1, max_length=200)]
    agent: Annotated[int, Field(ge=1, lt=2**31)] | None = None


class Order(BaseModel):
    """One message from a browser: either of the two, and a number for the answer."""

    model_config = ConfigDict(extra="forbid")
    id: Annotated[int, Field(ge=0, lt=2**53)]
    ask: Ask | None = None
    mark: Mark | None = None

    @model_validator(mode="after")
    def _check_one(self) -> Self:
        if (self.ask is None) == (self.mark is None):
            raise ValueError(
                "a message from the page must contain either the field `ask` or the field `mark`, but not both"
            )
        return self


class Orders:
    """Carries orders out, in threads beside the server's, for a service may take seconds to answer.

    Attributes:
        client: the session by which they go; None while there is none.
        refused: what was refused, for the node to count.
    """

    def __init__(self, sensor: str, refused: deque[str]) -> None:
        self.client: Client | None = None
        self.refused = refused
        self._sensor = sensor
        self._open: dict[str, tuple[object, Mark]] = {}  # by segment, of the browser that has marked its start
        self._asking = ThreadPoolExecutor(AT_ONCE, "asking")
        self._marking = ThreadPoolExecutor(1, "marking")  # one, so that no end overtakes its start

    async def carry_out(self, received: str, browser: object = None) -> str:
        """Carry out one message from a browser, and return the answer as JSON; `leave` ends what that browser marks."""
        try:
            order = Order.model_validate_json(received)
        except ValidationError as error:
            return self.refuse(_number_of(received), problems(error))
        loop = asyncio.get_running_loop()
        try:
            if order.mark is not None:
                return await loop.run_in_executor(self._marking, self._mark, order.id, order.mark, browser)
            assert order.ask is not None
            return await loop.run_in_executor(self._asking, self._ask, order.id, order.ask)
        except Refusal as refusal:
            return self.refuse(order.id, str(refusal), refused=True)
        except (ValueError, NotAnsweredError) as error:
            return self.refuse(order.id, str(error))
        except Exception:
            log.exception(
                "a bug occurred in web_dashboard while it carried out a request from the page, so perhaps only a part "
                "of the request is done. web_dashboard continues to run. Report the bug with the lines that follow"
            )
            return self.refuse(
                order.id,
                "a bug occurred in web_dashboard, so perhaps only a part of this request is done: report the bug with "
                "the last lines of web_dashboard's log",
            )

    def refuse(self, number: int | None, refusal: str, refused: bool = False) -> str:
        """Count a refusal, and return it as an answer; `refused` says that the service itself does not do it."""
        self.refused.append(refusal)
        return text(id=number, error=refusal, refused=refused)

    def leave(self, browser: object) -> None:
        """End the segments that a browser has left open: nobody else would."""
        self._marking.submit(self._end_marks, browser)

    def _end_marks(self, browser: object) -> None:
        for mark in [mark for owner, mark in self._open.values() if owner is browser]:
            del self._open[mark.segment_id]
            try:
                self._put(self._connected(), mark.model_copy(update={"kind": "end"}))
            except Exception as error:
                self.refused.append(f"{mark.segment_id} was not ended when its page was closed: {error}")

    def _mark(self, number: int, mark: Mark, browser: object) -> str:
        client = self._connected()
        if mark.kind == "start" and not client.wait_for_subscriber(keys.SEGMENT, CLASSIFIER_S):
            raise ValueError("no service receives marks: start som_classifier, or all services with 'actum up'")
        self._put(client, mark)
        self._open.pop(mark.segment_id, None)
        if mark.kind == "start":
            self._open[mark.segment_id] = browser, mark
            for oldest in list(self._open)[:-MOST_OPEN_SEGMENTS]:
                del self._open[oldest]
        return text(id=number, reply={})

    def _put(self, client: Client, mark: Mark) -> None:
        client.put(Segment(sensor=self._sensor, origin=MANUAL, **mark.model_dump()))

    def _ask(self, number: int, ask: Ask) -> str:
        return text(id=number, reply=self._connected().ask(ask.service, ask.command, **ask.fields))

    def _connected(self) -> Client:
        if self.client is None or not self.client.connected():
            raise ValueError(NO_ROUTER)
        return self.client


def _number_of(received: str) -> int | None:
    """Return the number of an order that is otherwise wrong, None where it has none."""
    try:
        number = json.loads(received)["id"]
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    return number if isinstance(number, int) else None
