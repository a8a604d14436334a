"""`actum play`: recordings as if they were a live sensor."""

from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.recording import RecordingError
from actum.runtime import stop_on_signals
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import connect, fail, failing_on, say
from actum_command.streaming import put_all

WAIT_S = 5.0
"""How long to wait for a preprocessor that is starting to subscribe (s)."""


def play(
    files: Annotated[
        list[Path], typer.Argument(help="recordings, or folders of recordings, which are played one after another")
    ],
    speed: Annotated[float, typer.Option(min=0.01, help="playback speed; 1 is real time, 2 is twice as fast")] = 1.0,
    person: PersonOption = None,
    with_excluded: AllOption = False,
) -> None:
    """Play recordings like a live sensor: publish the frames and the start and end marks of actions, but no labels."""
    recordings = chosen(files, person, with_excluded)
    stop = stop_on_signals()
    with connect() as client:
        if not client.wait_for_subscriber(keys.SKELETON, WAIT_S):
            fail(f"no service receives skeletons on {keys.key(keys.SKELETON, client.sensor)}: start pose_preprocessor")
        with failing_on(RecordingError):
            count = put_all(client, recordings, speed, stop)
    tell_unread(recordings)
    say(f"played {len(recordings)} recordings: {count} messages")
