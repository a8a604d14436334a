"""`actum segment`: start and end marks from the command line."""

import select
import sys
import time
from collections.abc import Callable, Iterator
from typing import Annotated, Literal

import typer
from pydantic import ValidationError
from rich.markup import escape

from actum import keys
from actum.messages import MANUAL, Action, Event, Message, Segment
from actum.runtime import Client, Listening
from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.recording_options import AgentOption
from actum_command.commands.service_flags import with_router_flags
from actum_command.commands.terminal import connect, console, fail, say, settings
from actum_command.describing import describe

ANSWER_S = 6.0  # at most 2 s for the classifier's late frames and 2 s for the fusion's late objects, and a margin
POLL_S = 0.02  # less than a frame's interval
WAIT_S = 5.0  # how long to wait for a classifier that is starting to subscribe

app = PlainTyper(
    no_args_is_help=True,
    help=(
        "Mark the start and the end of an action by hand. Use marks to label actions while recording, or to choose the "
        "exact segment in which the classifier recognises an action."
    ),
)

Id = Annotated[
    str,
    typer.Argument(
        help=(
            "any name for this action, such as a1. Use the same name for the start and the end, and a new name for "
            "each action"
        )
    ),
]
HandOption = Annotated[str | None, typer.Option(help="the hand that acts, left or right; default: not specified")]
LabelOption = Annotated[
    str | None,
    typer.Option(
        help=("label of the action, such as wave. 'actum record' stores this label for training. Default: no label")
    ),
]
StampOption = Annotated[
    int | None,
    typer.Option(
        min=0,
        help=(
            "time of the mark (ns), by the same clock as the field 'stamp_ns' of the sensor's messages. Default: now"
        ),
    ),
]


@app.command()
@with_router_flags
def start(
    segment_id: Id,
    agent: AgentOption = None,
    hand: HandOption = None,
    label: LabelOption = None,
    stamp_ns: StampOption = None,
) -> None:
    """Mark the start of an action. To mark the end of this action, use 'actum segment end' with the same SEGMENT_ID."""
    mark = _mark("start", segment_id, agent=agent, hand=hand, label=label, stamp_ns=stamp_ns)
    with connect() as client:
        _put(client, mark)


@app.command()
@with_router_flags
def end(segment_id: Id, stamp_ns: StampOption = None) -> None:
    """Mark the end of the action whose start has the same SEGMENT_ID.

    The classifier then publishes which action it recognised.
    """
    mark = _mark("end", segment_id, stamp_ns=stamp_ns)
    with connect() as client:
        _put(client, mark)


@app.command()
@with_router_flags
def toggle(label: LabelOption = None, agent: AgentOption = None, hand: HandOption = None) -> None:
    """Mark actions with the Enter key: first the start of an action, then its end. Ctrl-D quits.

    After each end mark, the command prints which action was recognised.
    """
    with connect() as client:
        answers, number = Answers(client), 0
        while _waits_for_enter(f"press Enter to start action {number + 1}, Ctrl-D to quit "):
            number += 1
            segment_id = f"toggle-{client.run}-{number}"
            _put(client, _mark("start", segment_id, agent=agent, hand=hand, label=label))
            ended = _waits_for_enter(f"press Enter to end action {number} ")
            _put(client, _mark("end", segment_id))
            for line in answers.until(segment_id, interrupted=_enter_was_pressed):
                console.print(line, soft_wrap=True)
            if not ended:
                return


def _mark(kind: Literal["start", "end"], segment_id: str, **fields: object) -> Segment:
    """Return a mark with the fields that are given, or fail where it is none."""
    if fields.get("hand") not in (None, "left", "right"):
        fail(f"--hand {fields['hand']!r} is not a hand: use left or right")
    own = {"sensor": settings().sensor, "kind": kind, "segment_id": segment_id, "origin": MANUAL}
    try:
        return Segment.model_validate(own | fields)
    except ValidationError as error:
        fail("; ".join(f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in error.errors(include_url=False)))


def _put(client: Client, mark: Segment) -> None:
    if not client.wait_for_subscriber(keys.SEGMENT, WAIT_S):
        fail(
            f"no service receives marks on {keys.key_of(mark)}, so the {mark.kind} mark was not sent: check with "
            "'actum doctor' that som_classifier runs"
        )
    client.put(mark)
    say(f"{mark.kind} {mark.segment_id}")


def _enter_was_pressed() -> bool:
    """Tell whether somebody has pressed Enter at a terminal; a script's input is always ready and does not count."""
    return sys.stdin.isatty() and bool(select.select([sys.stdin], [], [], 0)[0])


def _waits_for_enter(prompt: str) -> bool:
    try:
        input(prompt)
    except EOFError:
        print()
        return False
    return True


class Answers:
    """Waits for the answers to segments; late answers to earlier segments are described when they arrive."""

    def __init__(self, client: Client) -> None:
        self._events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        self._actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        self._pending: dict[str, Action | None] = {}

    def until(self, segment_id: str, interrupted: Callable[[], bool]) -> Iterator[str]:
        """Yield lines of console markup until a segment's event has come, for `ANSWER_S`, or until interrupted."""
        self._pending[segment_id] = None
        deadline_s = time.monotonic() + ANSWER_S
        while True:
            yield from self._new_events()
            if segment_id not in self._pending:
                return
            if time.monotonic() >= deadline_s:
                break
            if interrupted():
                return
            time.sleep(POLL_S)
        action = self._pending.pop(segment_id)
        if action is None:
            yield f"[yellow]{escape(segment_id)}: no answer within {ANSWER_S:g} s: run 'actum doctor'[/yellow]"
        else:
            yield f"{describe(action)}; no event arrived: check that action_fusion runs"

    def _new_events(self) -> Iterator[str]:
        """Describe the events of pending segments that have arrived, and keep their final actions."""
        for message in _messages(self._actions):
            if isinstance(message, Action) and message.final and message.segment_id in self._pending:
                self._pending[message.segment_id] = message
        for message in _messages(self._events):
            if isinstance(message, Event) and message.segment_id in self._pending:
                del self._pending[message.segment_id]
                yield describe(message)


def _messages(listening: Listening) -> Iterator[Message]:
    while (received := listening.receive()) is not None:
        if received.message is not None:
            yield received.message
