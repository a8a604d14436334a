"""`actum import`: public data sets as recordings."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from actum_command.context import console, fail
from actum_command.importing import ImportReport, Progress, import_bimacs, import_msr_action3d, import_utkinect
from actum_command.progress import bars
from sensor_gateway.takes import DatasetError

app = typer.Typer(no_args_is_help=True, help="Turn public data sets into recordings.")

Source = Annotated[Path, typer.Argument(help="the folder of the data set", exists=True)]
Out = Annotated[Path, typer.Argument(help="the folder to write to")]


@app.command("msr-action3d")
def msr_action3d(source: Source, out: Out) -> None:
    """Import MSR Action3D: one recording per sequence."""
    _run(import_msr_action3d, source, out)


@app.command("utkinect")
def utkinect(source: Source, out: Out) -> None:
    """Import UTKinect-Action3D: one recording per file, with its labelled segments."""
    _run(import_utkinect, source, out)


@app.command("bimacs")
def bimacs(source: Source, out: Out) -> None:
    """Import OptiTrack takes of two hands and objects: one recording per take, with each hand's labelled segments."""
    _run(import_bimacs, source, out)


def _run(importer: Callable[[Path, Path, Progress], ImportReport], source: Path, out: Path) -> None:
    try:
        with bars() as progress:
            report = importer(source, out, lambda done, total: progress("importing", done, total))
    except (DatasetError, OSError) as error:
        fail(str(error))
    console.print(str(report))
    console.print(f"written to {out}")
