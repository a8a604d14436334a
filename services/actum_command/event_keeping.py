"""Runs the service that keeps events, as this process."""

from contextlib import ExitStack
from pathlib import Path

from actum import steady_clock
from actum.runtime import run
from actum_command.history.event_files import EventFiles
from actum_command.history.event_recorder import EventRecorder
from actum_command.history.settings import Settings
from actum_command.service_settings import HISTORY, Given, arguments_of


def keep_events(folder: Path, given: Given) -> None:
    """Store events in a folder until SIGTERM or SIGINT, and finish the file that is open then."""
    with ExitStack() as ending:

        def build(settings: Settings) -> EventRecorder:
            if folder.suffix == ".mcap" or folder.is_file():
                raise ValueError(f"{folder} looks like a file, but --events writes several files: give a folder")
            files = EventFiles(folder, settings.sensor, settings)
            recorder = EventRecorder(files, steady_clock.now_ns)
            ending.callback(recorder.close)
            return recorder

        run(Settings, build, arguments_of(HISTORY, given))
