"""`actum inspect`: pictures of what a model has learnt and of its answers to recordings."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from actum.recording import Recording, RecordingError
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import fail, refuse_without, say
from actum_model_trainer.progress import Progress
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, load_model
from som_classifier.model_maps import NoMapsError, maps_of

FORMATS = ("png", "svg")
"""Formats that pictures can be written in."""

UNMARKED = (
    "the given recordings contain no marked action: mark when actions start and end, either while recording (see "
    "'actum segment --help') or afterwards with 'actum label'"
)
"""What is wrong and what to do where recordings have no marked segment."""

FILES = (".png", ".svg", ".html", ".pdf")
"""Endings by which a name given as the folder is taken for that of a file."""


def inspect(
    model_file: Annotated[Path, typer.Argument(metavar="MODEL", help="the model file to draw")],
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help=(
                "the folder to which the pictures and index.html are written. The command deletes the pictures of an "
                "earlier run from this folder"
            ),
        ),
    ],
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[REC]...",
            help=(
                "recordings, or folders of recordings. The command also draws how the model recognises the actions in "
                "these recordings. Default: the command draws only the model"
            ),
        ),
    ] = None,
    person: PersonOption = None,
    picture_format: Annotated[
        str, typer.Option("--format", help=f"file format of the pictures: {' or '.join(FORMATS)}")
    ] = "png",
    with_excluded: AllOption = False,
) -> None:
    """Draw what a model has learnt and, if you name recordings, how the model recognises the actions in the recordings.

    The command writes pictures, and a page that shows all pictures (index.html).
    """
    began_s = time.monotonic()
    if picture_format not in FORMATS:
        fail(f"--format {picture_format!r} is not known: use one of {', '.join(FORMATS)}")
    if output.suffix.lower() in FILES:
        fail(f"{output} looks like a file: give a folder for the pictures and index.html")
    if output.exists() and not output.is_dir():
        fail(f"{output} is not a folder: give a folder for the pictures and index.html")
    refuse_without("matplotlib", "matplotlib, which draws the pictures,", "model-inspector")
    try:
        model = load_model(model_file)
        output.mkdir(parents=True, exist_ok=True)
        recordings = chosen(files, person, with_excluded) if files else []
        with bars() as progress:
            count = _write_inspection(model, recordings, output, picture_format, progress)
    except NoMapsError as error:
        fail(
            f"{error}: give recordings in addition to the model. The command then draws pictures of what the model "
            "recognises in these recordings"
        )
    except (ModelError, RecordingError, OSError) as error:
        fail(str(error))
    tell_unread(recordings)
    if not count:
        fail(UNMARKED)
    say(f"{count} pictures in {time.monotonic() - began_s:.1f} s: open {output / 'index.html'}")


def _write_inspection(
    model: Model, recordings: Sequence[Recording], folder: Path, ending: str, progress: Progress
) -> int:
    """Write pictures and page, and return how many pictures there are: 0 where recordings have no marked segment.

    Raises:
        NoMapsError: there are no recordings, and the model has no maps.
        RecordingError: a recording is damaged.
        OSError: something cannot be written.
    """
    from actum_model_inspector.answered import answered_segments  # Matplotlib takes its time and need not be installed
    from actum_model_inspector.folder import PAGE, note
    from actum_model_inspector.html_page import page
    from actum_model_inspector.inspection import pictures, write
    from actum_model_trainer.evaluation import evaluate

    if not recordings and maps_of(model) is None:
        raise NoMapsError(model)
    segments = answered_segments(model, recordings, progress)
    if recordings and not segments:
        return 0
    labelled = any(segment.label is not None for segment in segments)
    evaluation = evaluate(model, recordings, progress) if labelled else None
    planned = list(pictures(model, segments, evaluation))
    written = write(planned, folder, ending, progress)
    index = folder / PAGE
    index.write_text(page(model, segments, evaluation, planned, written), encoding="utf-8")
    note(index)
    return len(planned)
