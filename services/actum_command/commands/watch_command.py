"""`actum watch`: what happens on a sensor's keys, one line per message."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated

import typer
from rich.live import Live

from actum import keys
from actum.messages import Action
from actum.recording import Recording, RecordingError
from actum.recording_files import recording_files
from actum.runtime import Client, Received
from actum_command.commands.recording_options import unread
from actum_command.commands.terminal import connect, console, errors, fail, failing_on
from actum_command.describing import OngoingLines, json_line, line
from actum_command.intent_lines import IntentLines

WATCHABLE = {topic.leaf.removesuffix("/{}"): topic for topic in keys.TOPICS}
"""All topics, by the name that a user gives them."""
BY_DEFAULT = [keys.EVENT]
PATIENCE_S = 5.0
"""How long (s) the services of the sensor may take to start before their absence is reported."""


def watch(
    topics: Annotated[
        list[str] | None,
        typer.Argument(help=f"kinds of messages to print, one or more of {', '.join(WATCHABLE)}; default: event"),
    ] = None,
    as_json: Annotated[
        bool,
        typer.Option(
            "--json",
            help="print each message with all its fields as one line of JSON; binary fields are base64 (URL-safe)",
        ),
    ] = False,
    with_held_back: Annotated[
        bool,
        typer.Option(
            "--held-back",
            help="also print the segments that the classifier found but did not publish, each with the reason",
        ),
    ] = False,
    recorded: Annotated[
        list[Path] | None,
        typer.Option(
            "--from",
            help=(
                "print the messages of these recordings, or of all recordings in these folders, instead of live "
                "messages"
            ),
        ),
    ] = None,
) -> None:
    """Print live messages until Ctrl-C, one message per line: time, key, segment id and content.

    On a terminal, a line at the bottom also shows each person's ongoing action and its completeness. With --from, the
    command prints the messages of recordings instead, even of a file that 'actum record --events' is still writing.

    A message on the topic 'intent' (the objects that a hand reaches for) is printed only if the likeliest object
    changes, if the probability of this object reaches 0.5 or 0.9 for the first time, or if the hand's movement ends.
    With --json, all these messages are printed.
    """
    named = {name: WATCHABLE.get(name) or WATCHABLE.get(name.removesuffix("s")) for name in topics or []}
    for name in (name for name, topic in named.items() if topic is None):
        fail(f"{name!r} is not a topic: use one or more of {', '.join(WATCHABLE)}")
    wanted = [topic for topic in named.values() if topic is not None] or [*BY_DEFAULT]
    wanted += [keys.HELD_BACK] if with_held_back and keys.HELD_BACK not in wanted else []
    printed = Printed(as_json)
    if recorded:
        _show_recorded(recorded, wanted, printed)
        return
    with connect() as client, _reporting_absence(client):
        try:
            if console.is_terminal and not as_json and {keys.EVENT, keys.ACTION} & {*wanted}:
                _show_above_what_goes_on(client, wanted, printed)
            else:
                for received in _received_on(client, wanted):
                    printed.take(received)
        except KeyboardInterrupt:
            return


@contextmanager
def _reporting_absence(client: Client) -> Iterator[None]:
    """Return a context in which it is reported, after a while, that no service of the client's sensor runs."""

    def report() -> None:
        sensors = client.sensors()
        if client.sensor not in sensors:
            there = (
                f"services run for {', '.join(sensors)}" if sensors else "no service of any other sensor runs either"
            )
            _remark(f"waiting for messages of the sensor {client.sensor}, for which no service runs; {there}")

    timer = threading.Timer(PATIENCE_S, report)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()


def _received_on(client: Client, topics: list[keys.Topic]) -> Iterator[Received]:
    """Yield the messages that arrive on the topics, from now on."""
    pattern = keys.pattern(topics[0], client.sensor) if len(topics) == 1 else keys.everything(client.sensor)
    for received in client.listen(pattern):
        with suppress(keys.InvalidKeyError):  # a key of somebody else's below the sensor's
            if keys.parse(received.key).topic in topics:
                yield received


class Printed:
    """The lines on the terminal: each message as JSON, or in words those that say something new."""

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json
        self._intents = IntentLines()

    def take(self, received: Received) -> None:
        """Print a message."""
        if self._as_json:
            print(json_line(received), flush=True)
        elif self._intents.include(received.message):
            console.print(line(received), soft_wrap=True)


def _show_recorded(named: list[Path], wanted: list[keys.Topic], printed: Printed) -> None:
    """Print the messages of recordings on the wanted topics, one recording after another by name."""
    found = recording_files(named)
    for remark in found.remarks:
        _remark(remark)
    if not found.paths:
        fail(
            f"there are no recordings in {', '.join(map(str, named))}: give *.mcap files, or folders that contain "
            "such files"
        )
    with failing_on(RecordingError):
        for recording in map(Recording, found.paths):
            for message in recording.messages(wanted):
                printed.take(Received(keys.key_of(message), message, None, 0))
            for line_ in unread([recording]):
                _remark(line_)


def _remark(text: str) -> None:
    """Print a line where it does not get among the messages."""
    errors.print(text, markup=False, soft_wrap=True, style="yellow")


def _show_above_what_goes_on(client: Client, wanted: list[keys.Topic], printed: Printed) -> None:
    """Print a line for each wanted message but the partial actions; of these show the newest of each person below."""
    ongoing = OngoingLines()
    client.follow(keys.pattern(keys.ACTION, client.sensor), lambda received: ongoing.receive(received.message))
    with Live(ongoing, console=console, transient=True):
        for received in _received_on(client, wanted):
            if not isinstance(received.message, Action) or received.message.final:
                printed.take(received)
