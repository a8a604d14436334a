"""`actum watch`: what happens on a sensor's keys, one line per message."""

import threading
from typing import Annotated

import typer
from rich.live import Live

from actum import keys
from actum.messages import Action
from actum.runtime import Client
from actum_command.commands.terminal import connect, console, fail
from actum_command.message_lines import WATCHABLE, json_line, line, received_on
from actum_command.ongoing_lines import OngoingLines

BY_DEFAULT = [keys.EVENT]


def watch(
    topics: Annotated[list[str] | None, typer.Argument(help=f"any of {', '.join(WATCHABLE)}; default: event")] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object a line, with all fields; bytes are URL-safe base64")
    ] = False,
) -> None:
    """Print what happens, one line per message: when, on which key, in which segment, what; until Ctrl-C.

    On a terminal, events and actions stand above a line for each person: what they are doing and how far it is.
    """
    unknown = [name for name in topics or [] if name not in WATCHABLE]
    if unknown:
        fail(f"no topic {unknown[0]!r}: use any of {', '.join(WATCHABLE)}")
    wanted = [WATCHABLE[name] for name in topics] if topics else BY_DEFAULT
    with connect() as client:
        try:
            if console.is_terminal and not as_json and {keys.EVENT, keys.ACTION} & {*wanted}:
                _show_above_what_goes_on(client, wanted)
            else:
                for received in received_on(client, wanted):
                    if as_json:
                        print(json_line(received), flush=True)
                    else:
                        console.print(line(received), soft_wrap=True)
        except KeyboardInterrupt:
            return


def _show_above_what_goes_on(client: Client, wanted: list[keys.Topic]) -> None:
    """Print a line for each wanted message but the partial actions; of these show the newest of each person below."""
    ongoing = OngoingLines()

    def follow() -> None:
        for received in received_on(client, [keys.ACTION]):
            ongoing.take(received.message)

    threading.Thread(target=follow, daemon=True).start()
    with Live(ongoing, console=console, transient=True):
        for received in received_on(client, wanted):
            if not isinstance(received.message, Action) or received.message.final:
                console.print(line(received), soft_wrap=True)
