"""`actum import`: public data sets as recordings."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.progress_bars import bars
from actum_command.commands.terminal import fail, failing_on, say
from actum_dataset_importer.clips import DEFAULT_PATTERN, Naming
from actum_dataset_importer.importing import (
    ImportReport,
    Progress,
    import_bimacs,
    import_msr_action3d,
    import_msrc12,
    import_msrc12_composed,
    import_msrc12_trimmed,
    import_utkinect,
    import_video,
)
from actum_dataset_importer.takes import DatasetError
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.settings import Settings

app = PlainTyper(
    no_args_is_help=True,
    help="Convert public data sets and video clips to recordings, to train or test a model on them.",
)

Source = Annotated[Path, typer.Argument(help="the folder that contains the downloaded data set", exists=True)]
Out = Annotated[Path, typer.Argument(help="the folder to which the recordings are written")]


@app.command("msr-action3d")
def msr_action3d(source: Source, out: Out) -> None:
    """Import the data set MSR Action3D; each sequence becomes a recording with one labelled action."""
    _run(import_msr_action3d, source, out)


@app.command("utkinect")
def utkinect(source: Source, out: Out) -> None:
    """Import the data set UTKinect-Action3D; each file becomes a recording with labelled segments."""
    _run(import_utkinect, source, out)


@app.command("msrc12")
def msrc12(
    source: Source,
    out: Out,
    trimmed: Annotated[
        bool,
        typer.Option(
            "--trimmed",
            help=(
                "start and end each segment where the movement visibly starts and ends. Default: a segment extends up "
                "to 1.5 s before and after the point in time that the data set gives for the gesture"
            ),
        ),
    ] = False,
    composed: Annotated[
        bool,
        typer.Option(
            "--composed",
            help=(
                "write two recordings per person. In each recording, the person does all gestures in mixed order, and "
                "segments start and end as with --trimmed. Default: one recording per sequence of the data set"
            ),
        ),
    ] = False,
) -> None:
    """Import the data set MSRC-12; each sequence becomes a recording with labelled segments.

    The data set gives one point in time per gesture. Each segment extends up to 1.5 s before and after this point.
    """
    if trimmed and composed:
        fail("--composed and --trimmed cannot be used together, because --composed already trims: leave out --trimmed")
    importer = import_msrc12_composed if composed else import_msrc12_trimmed if trimmed else import_msrc12
    _run(importer, source, out)


@app.command("bimacs")
def bimacs(source: Source, out: Out) -> None:
    """Import OptiTrack motion capture of two hands and objects, labelled as in the KIT Bimanual Actions Dataset.

    The folder SOURCE contains files such as subject0_take0.csv. Each file becomes a recording with labelled segments of
    each hand. The recordings contain hands without bodies, so models cannot be trained or tested on them; programs can
    read the paths of hands and objects.
    """
    _run(import_bimacs, source, out)


@app.command("video")
def video(
    source: Annotated[Path, typer.Argument(help="a folder of video clips; each clip shows one action", exists=True)],
    out: Out,
    pattern: Annotated[
        str,
        typer.Option(
            help=(
                "regular expression for the file names without extension. The named group 'action' matches the label "
                "of the recording; the optional named group 'person' matches the person"
            )
        ),
    ] = DEFAULT_PATTERN,
    names: Annotated[
        str,
        typer.Option(
            help=(
                "labels for the actions in the file names, such as 1=wave,2=drink if the file names contain numbers "
                "instead of labels. Default: the label is the action as written in the file name"
            )
        ),
    ] = "",
    people: Annotated[int, typer.Option(min=1, max=4, help="maximum number of people to find in a clip")] = 1,
) -> None:
    """Import video clips that show one action each and are named after action and person, such as wave_anna_2.mp4.

    Each clip becomes a recording with one labelled segment and without images. The camera's settings come from the
    environment variables ACTUM_POSE_MODEL, ACTUM_CALIBRATION (or ACTUM_FIELD_OF_VIEW_DEG), ACTUM_MIRRORED and
    ACTUM_PERSON_HEIGHT_M.
    """
    with failing_on(ValueError):
        naming, settings = Naming.of(pattern, names), Settings(people=people)
        opened = partial(estimator_of, settings)
        with opened():
            pass
        _run(partial(import_video, naming=naming, optics=optics_of(settings), opened=opened), source, out)


def _run(importer: Callable[[Path, Path, Progress], ImportReport], source: Path, out: Path) -> None:
    with failing_on(DatasetError, OSError), bars() as progress:
        report = importer(source, out, lambda done, total: progress("importing", done, total))
    say(str(report))
    say(f"written to {out}")
