"""`actum watch`: what happens on a sensor's keys, one line per message."""

from typing import Annotated

import typer

from actum_command.commands.terminal import connect, console, fail
from actum_command.message_lines import WATCHABLE, json_line, line, received_on


def watch(
    topics: Annotated[list[str] | None, typer.Argument(help=f"any of {', '.join(WATCHABLE)}; default: event")] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object a line, with all fields; bytes are URL-safe base64")
    ] = False,
) -> None:
    """Print what happens, one line per message: when, on which key, in which segment, what; until Ctrl-C."""
    unknown = [name for name in topics or [] if name not in WATCHABLE]
    if unknown:
        fail(f"no topic {unknown[0]!r}: use any of {', '.join(WATCHABLE)}")
    with connect() as client:
        try:
            for received in received_on(client, [WATCHABLE[name] for name in topics or ["event"]]):
                if as_json:
                    print(json_line(received), flush=True)
                else:
                    console.print(line(received), soft_wrap=True)
        except KeyboardInterrupt:
            return
