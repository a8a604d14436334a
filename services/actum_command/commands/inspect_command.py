"""`actum inspect`: pictures of what a model has learnt and of its answers to recordings."""

import time
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from actum.installing import adding
from actum.recording import RecordingError
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import fail, say
from actum_command.inspection_page import NoSegmentError, write_inspection
from som_classifier.model_loading import ModelError, load_model
from som_classifier.model_maps import NoMapsError

FORMATS = ("png", "svg")
"""Formats that pictures can be written in."""

FILES = (".png", ".svg", ".html", ".pdf")
"""Endings by which a name given as the folder is taken for that of a file."""


def inspect(
    model_file: Annotated[Path, typer.Argument(metavar="MODEL", help="the model file to draw")],
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="the folder for the pictures and index.html; pictures of an earlier run in this folder are removed",
        ),
    ],
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[REC]...",
            help=(
                "recordings, or folders of recordings; the command also draws how the model recognises the actions in "
                "them. Default: only the model is drawn"
            ),
        ),
    ] = None,
    person: PersonOption = None,
    picture_format: Annotated[
        str, typer.Option("--format", help=f"file format of the pictures: {' or '.join(FORMATS)}")
    ] = "png",
    with_excluded: AllOption = False,
) -> None:
    """Draw what a model has learnt and, if recordings are given, how the model recognises the actions in them.

    The command writes pictures, and a page that shows all pictures (index.html).
    """
    began_s = time.monotonic()
    if picture_format not in FORMATS:
        fail(f"--format {picture_format!r} is not known: use one of {', '.join(FORMATS)}")
    if output.suffix.lower() in FILES:
        fail(f"{output} looks like a file: give a folder for the pictures and index.html")
    if output.exists() and not output.is_dir():
        fail(f"{output} is not a folder: give a folder for the pictures and index.html")
    if find_spec("matplotlib") is None:
        fail(f"matplotlib, which draws the pictures, is not installed: {adding('model-inspector')}")
    try:
        model = load_model(model_file)
        output.mkdir(parents=True, exist_ok=True)
        recordings = chosen(files, person, with_excluded) if files else []
        with bars() as progress:
            count = write_inspection(model, recordings, output, picture_format, progress)
    except NoSegmentError as error:
        tell_unread(recordings)
        fail(str(error))
    except NoMapsError as error:
        fail(f"{error}: give recordings too, and the command draws how the model recognises the actions in them")
    except (ModelError, RecordingError, OSError) as error:
        fail(str(error))
    tell_unread(recordings)
    say(f"{count} pictures in {time.monotonic() - began_s:.1f} s: open {output / 'index.html'}")
