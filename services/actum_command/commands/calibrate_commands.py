"""`actum calibrate`: a camera's intrinsics, where one camera is seen from another, and how one is tilted."""

import datetime
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from actum.atomic_file import write_whole
from actum.calibration import Calibration, CalibrationError
from actum.keys import CHUNK
from actum.runtime import stop_on_signals
from actum_calibrator.board import Board, PatternError
from actum_calibrator.board_views import BoardFinder, View
from actum_calibrator.coverage_picture import coverage_picture
from actum_calibrator.extrinsics import Extrinsics, estimate_extrinsics, with_extrinsics
from actum_calibrator.grey_images import UnusablePictureError, complaints, read_grey
from actum_calibrator.intrinsics import Intrinsics, calibration_of, estimate_intrinsics
from actum_calibrator.pairs import Pair, PairingError, pair_files, pictures_in
from actum_calibrator.view_set import GOOD_COVERAGE, PoorSetError
from actum_command.commands.calibrate_up_command import up
from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.service_flags import with_router_flags
from actum_command.commands.terminal import connect, console, fail, failing_on, refuse_unwritable, say
from actum_command.live_calibration import SilentStreamError, collect_pairs, collect_views

app = PlainTyper(
    no_args_is_help=True,
    help=(
        "Measure a camera's lens, position and tilt. To measure the lens or the position, use the board that 'actum "
        "markers --board' prints. To measure the tilt, let a person stand in front of the camera."
    ),
)
app.command("up")(with_router_flags(up))

Output = Annotated[Path, typer.Option("-o", "--output", help="the calibration file to write (.yaml)")]
Squares = Annotated[
    str, typer.Option("--board", help="number of columns and rows of squares on the calibration board, such as 7x5")
]
SquareMm = Annotated[
    float,
    typer.Option(help="side length of one square on the calibration board, as you measure it on the print (mm)"),
]
MarkerMm = Annotated[
    float,
    typer.Option(help="side length of one marker on the calibration board, as you measure it on the print (mm)"),
]
Family = Annotated[
    str,
    typer.Option(help="family (OpenCV dictionary) of the markers on the calibration board, such as DICT_5X5_100"),
]


def _intrinsics_of(seen: str) -> Any:
    words = f"calibration file of the camera that sees the {seen}, written by 'actum calibrate intrinsics'"
    return typer.Option(exists=True, dir_okay=False, help=words)


@app.command("intrinsics")
@with_router_flags
def intrinsics(
    output: Output,
    images: Annotated[
        list[Path] | None, typer.Argument(help="pictures of the calibration board, or folders of such pictures")
    ] = None,
    live: Annotated[
        bool,
        typer.Option("--live", help="take the pictures from the running camera instead of from files"),
    ] = False,
    board: Squares = "7x5",
    square_mm: SquareMm = 35.0,
    marker_mm: MarkerMm = 26.0,
    family: Family = "DICT_5X5_100",
) -> None:
    """Measure a camera's focal lengths, centre and distortion from 15 to 20 pictures of the calibration board.

    Print the board with 'actum markers --board'. Calibrate each camera once, so that positions of people and objects
    are exact. The command writes a calibration file for the option --calibration of the sensor gateway. Beside this
    file, the command writes a picture that shows in which parts of the image the board was seen.
    """
    if live == bool(images):
        fail("give either pictures of the board or --live, not both; --live takes new pictures")
    files = [file for path in images or [] for file in (pictures_in(path) if path.is_dir() else [path])]
    picture = _coverage_picture_of(output, files)
    finder = BoardFinder(_board(board, square_mm, marker_mm, family))
    views, unusable = (_live_views(finder), []) if live else _views(finder, files)
    with _refusing_poor(unusable, output):
        fit = estimate_intrinsics(views)
    calibration = calibration_of(fit, _today())
    with failing_on(OSError):
        output.parent.mkdir(parents=True, exist_ok=True)
        calibration.save(output)
        write_whole(picture, coverage_picture(fit, views))
    _report_intrinsics(fit)
    say(f"written to {output} (calibration {calibration.id}); look at {picture}")


@app.command("extrinsics")
@with_router_flags
def extrinsics(  # noqa: PLR0913, PLR0917 - one parameter is one option
    markers_camera: Annotated[Path, _intrinsics_of("markers")],
    people_camera: Annotated[Path, _intrinsics_of("people")],
    output: Output,
    pairs: Annotated[
        list[Path] | None,
        typer.Argument(
            help=(
                "pairs of pictures of the calibration board; both cameras took the two pictures of a pair at the same "
                "time. In each pair, NAME_a.png is from the camera that sees the markers, and NAME_b.png is from the "
                "camera that sees the people. Alternatively, name two folders in which the two pictures of a pair have "
                "the same file name: first the folder of the camera that sees the markers, then the folder of the "
                "other camera"
            )
        ),
    ] = None,
    live: Annotated[
        str | None,
        typer.Option(
            help=(
                "take the pictures from two running cameras instead of from files. Name the sensors of both cameras, "
                "such as kinect1,kinect0: first the camera that sees the markers, then the camera that sees the people"
            )
        ),
    ] = None,
    board: Squares = "7x5",
    square_mm: SquareMm = 35.0,
    marker_mm: MarkerMm = 26.0,
    family: Family = "DICT_5X5_100",
) -> None:
    """Measure the position of a camera that sees the markers, relative to a second camera that sees the people.

    Use this command only if the markers and the people are seen by different cameras. First run 'actum calibrate
    intrinsics' for each camera. Then take 6 to 10 pairs of pictures of the board that 'actum markers --board' prints.
    The command writes a calibration file for the camera that sees the markers.
    """
    if (live is not None) == bool(pairs):
        fail(
            "give either pairs of pictures or --live, not both; --live needs the names of the two sensors, such as "
            "--live kinect1,kinect0"
        )
    refuse_unwritable(output, ".yaml", ".yml")
    finder = BoardFinder(_board(board, square_mm, marker_mm, family))
    with failing_on(CalibrationError, PairingError, OSError):
        cameras = Calibration.load(markers_camera), Calibration.load(people_camera)
        usable, unusable = (_live_pairs(_sensors(live), finder), []) if live else _pairs(finder, pairs or [])
        with _refusing_poor(unusable, output):
            fit = estimate_extrinsics(usable, *cameras)
        calibration = with_extrinsics(cameras[0], fit, _today())
        output.parent.mkdir(parents=True, exist_ok=True)
        calibration.save(output)
    _report_extrinsics(fit, usable)
    say(f"written to {output} (calibration {calibration.id})")


def _board(squares: str, square_mm: float, marker_mm: float, family: str) -> Board:
    columns, _, rows = squares.partition("x")
    if not (columns.isdecimal() and rows.isdecimal()):
        fail(f"--board {squares!r} does not give the numbers of squares: write COLUMNSxROWS, such as 7x5")
    with failing_on(PatternError):
        return Board(int(columns), int(rows), square_mm / 1000, marker_mm / 1000, family)


def _coverage_picture_of(output: Path, pictures: Sequence[Path]) -> Path:
    """Return the path of the coverage picture, beside the calibration; fail where either would replace an input."""
    refuse_unwritable(output, ".yaml", ".yml")
    picture = output.with_name(f"{output.stem}-coverage.png")
    inputs = {file.resolve() for file in pictures}
    for written in (output, picture):
        if written.resolve() in inputs:
            fail(f"the output would overwrite the input picture {written}: give another output file with -o")
    return picture


def _sensors(text: str) -> tuple[str, str]:
    markers, _, people = text.partition(",")
    if not CHUNK.fullmatch(markers) or not CHUNK.fullmatch(people) or markers == people:
        fail(
            f"--live {text!r} does not name two sensors: give first the sensor that sees the markers, then the sensor "
            "that sees the people, such as kinect1,kinect0"
        )
    return markers, people


def _views(finder: BoardFinder, files: Sequence[Path]) -> tuple[list[View], list[UnusablePictureError]]:
    """Return the board's view in each picture, and the errors of those that cannot be used, which are printed."""
    views: list[View] = []
    unusable: list[UnusablePictureError] = []
    for file in files:
        try:
            views.append(finder.find(read_grey(file), file.name))
        except UnusablePictureError as error:
            unusable.append(error)
            say(str(error), style="yellow")
    return views, unusable


def _live_views(finder: BoardFinder) -> list[View]:
    with connect() as client, failing_on(SilentStreamError):
        return collect_views(client, finder, stop_on_signals(), console.print)


def _live_pairs(sensors: tuple[str, str], finder: BoardFinder) -> list[Pair]:
    console.print("hold the board still where both cameras see it; change its place and its tilt for each pair")
    with connect() as client, failing_on(SilentStreamError):
        return collect_pairs(client, sensors, finder, stop_on_signals(), console.print)


def _pairs(finder: BoardFinder, paths: Sequence[Path]) -> tuple[list[Pair], list[UnusablePictureError]]:
    """Return the board's views in all pairs, and the errors of pictures that cannot be used."""
    usable: list[Pair] = []
    unusable: list[UnusablePictureError] = []
    for name, markers, people in pair_files(paths):
        views, problems = _views(finder, [markers, people])
        unusable += problems
        if not problems:
            usable.append(Pair(name, *views))
    return usable, unusable


def _report_intrinsics(fit: Intrinsics) -> None:
    fx, fy = fit.matrix[0, 0], fit.matrix[1, 1]
    console.print(f"RMS {fit.rms_px:.3f} px over {len(fit.residuals_px)} views of {fit.size[0]}x{fit.size[1]}")
    console.print(
        f"focal length {fx:.1f} ± {fit.deviations_px[0]:.1f} px across, {fy:.1f} ± {fit.deviations_px[1]:.1f} px down"
    )
    console.print(f"coverage {fit.coverage:.0%} of the image")
    if fit.bend_mm:
        console.print(
            f"[yellow]the board is bent by {fit.bend_mm:.1f} mm: this calibration allows for that, extrinsics "
            "cannot; glue the board to a flat surface[/yellow]",
            soft_wrap=True,
        )
    if fit.coverage < GOOD_COVERAGE:
        console.print(
            "[yellow]near the edges of the image the distortion is extrapolated: if objects will be there, add "
            "views with the board there[/yellow]",
            soft_wrap=True,
        )


def _report_extrinsics(fit: Extrinsics, pairs: Sequence[Pair]) -> None:
    x, y, z = fit.skeleton_from_image[:3, 3]
    console.print(f"RMS {fit.rms_px:.3f} px over {len(pairs)} pairs")
    for pair, error in zip(pairs, fit.rms_of_pairs_px, strict=True):
        say(f"  {pair.name}: {error:.3f} px")
    console.print(
        f"the camera that sees the markers is at x {x:+.3f}, y {y:+.3f}, z {z:+.3f} m (right, down, forward) from "
        f"the camera that sees the people, ± {fit.position_deviation_mm:.1f} mm and ± "
        f"{fit.rotation_deviation_deg:.2f} deg",
        soft_wrap=True,
    )


@contextmanager
def _refusing_poor(unusable: Sequence[UnusablePictureError], output: Path) -> Iterator[None]:
    """Return a context that ends the command where its pictures do not suffice, and names what each one lacks."""
    try:
        yield
    except PoorSetError as error:
        reasons = [*error.reasons, *complaints(unusable)]
        fail("\n  ".join([f"{output} was not written, because the calibration failed:", *reasons]))


def _today() -> datetime.date:
    return datetime.datetime.now().astimezone().date()
