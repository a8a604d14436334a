"""`actum inspect`: pictures of what a model has learnt and why it answers as it does."""

import time
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from actum.recording import Recording, RecordingError
from actum_command.context import fail, say
from actum_command.learning import AllOption, PersonOption, chosen, tell_unread
from actum_command.progress import bars
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, load_model

FORMATS = ("png", "svg")
FILES = (".png", ".svg", ".html", ".pdf")
"""Endings of what is written into the folder, or what might be looked for."""


def inspect_command(
    model_file: Annotated[Path, typer.Argument(metavar="MODEL", help="the model file to look into")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="the folder for pictures and index.html; those of an earlier run go")
    ],
    files: Annotated[
        list[Path] | None, typer.Argument(metavar="[REC]...", help="recordings to try it on, or folders of them")
    ] = None,
    person: PersonOption = None,
    picture_format: Annotated[str, typer.Option("--format", help=f"one of {', '.join(FORMATS)}")] = "png",
    with_excluded: AllOption = False,
) -> None:
    """Draw what a model has learnt, and with recordings how and why it recognises what they hold."""
    began_s = time.monotonic()
    if picture_format not in FORMATS:
        fail(f"--format is {picture_format!r}: use one of {', '.join(FORMATS)}")
    if output.suffix.lower() in FILES:
        fail(f"{output} is named as a file: name the folder to write pictures and index.html to")
    if output.exists() and not output.is_dir():
        fail(f"{output} is no folder: name the one to write pictures to")
    if find_spec("matplotlib") is None:
        fail("matplotlib draws the pictures and is not installed: pip install 'actum[model-inspector]'")
    try:
        model = load_model(model_file)
        output.mkdir(parents=True, exist_ok=True)
        recordings = chosen(files, person, with_excluded) if files else []
        count = _inspect(model, recordings, output, picture_format)
    except (ModelError, RecordingError, OSError) as error:
        fail(str(error))
    tell_unread(recordings)
    say(f"{count} pictures in {time.monotonic() - began_s:.1f} s: open {output / 'index.html'}")


def _inspect(model: Model, recordings: list[Recording], folder: Path, ending: str) -> int:
    """Write pictures and page, and return how many pictures there are."""
    from actum_model_inspector.anatomy import anatomy_of  # Matplotlib takes its time and need not be installed
    from actum_model_inspector.answered import answered_segments
    from actum_model_inspector.folder import note
    from actum_model_inspector.inspection import pictures, write
    from actum_model_inspector.page import page
    from actum_model_trainer.evaluation import evaluate

    anatomy = anatomy_of(model)
    with bars() as progress:
        segments = answered_segments(anatomy, recordings, progress)
        if recordings and not segments:
            tell_unread(recordings)
            fail("no segment in these recordings: start and end marks make one, see actum segment --help")
        labelled = any(segment.label is not None for segment in segments)
        evaluation = evaluate(model, recordings, progress) if labelled else None
        planned = list(pictures(anatomy, segments, evaluation))
        written = write(planned, folder, ending, progress)
    index = folder / "index.html"
    index.write_text(page(model, segments, evaluation, planned, written), encoding="utf-8")
    note(index)
    return len(planned)
