"""`actum tune`: picks the settings of the search for actions from labelled continuous recordings."""

import csv
import json
import shlex
import time
import tomllib
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Annotated

import typer

from actum.recording import RecordingError
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import console, fail, failing_on, refuse_unwritable, say, write_text
from actum_command.service_settings import flag_of
from actum_model_trainer.continuous.watching import NoSpotterError
from actum_model_trainer.tuning.tuning import NothingLabelledError, tuned
from actum_model_trainer.tuning.tuning_report import tuning_report
from som_classifier.model_loading import ModelError, load_model
from som_classifier.segmentation import Segmentation

SEARCH_SETTINGS = (
    "false_alarms_per_min",
    "shortest_pause_s",
    "cooldown_s",
    "enabled_actions",
    "disabled_actions",
)
"""The settings of the search, which the command picks and `actum evaluate --continuous` takes."""


def tune(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="the model file to tune")],
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="REC...",
            help=(
                "recordings, or folders of recordings. All actions in the recordings must be labelled. Between the "
                "actions, the recordings must also show other movement"
            ),
        ),
    ],
    false_alarms_per_min: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            help="maximum number of false alarms per minute while nobody does an action; default: no limit",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help=(
                "the file to which the chosen settings are written (.toml). Services read this file if ACTUM_CONFIG is "
                "set to the file's path. Default: the settings are only printed"
            ),
        ),
    ] = None,
    person: PersonOption = None,
    with_excluded: AllOption = False,
) -> None:
    """Choose the settings with which a model best finds actions by itself, and print the settings and their effect.

    The command chooses the classifier's settings --false-alarms-per-min, --shortest-pause-s, --cooldown-s and
    --disabled-actions.
    """
    began_s = time.monotonic()
    if false_alarms_per_min is not None and not 0 < false_alarms_per_min < float("inf"):
        fail(f"--false-alarms-per-min is {false_alarms_per_min:g}: give a number above 0")
    if output is not None:
        refuse_unwritable(output, ".toml")
        refuse_other_settings(output)
    with failing_on(ModelError, RecordingError, NoSpotterError, NothingLabelledError):
        loaded = load_model(model)
        recordings = chosen(files, person, with_excluded)
        with bars() as progress:
            result = tuned(loaded, recordings, false_alarms_per_min, progress)
    tell_unread(recordings)
    console.print(tuning_report(result, false_alarms_per_min, time.monotonic() - began_s))
    for doubt in result.doubts:
        say(doubt, style="yellow")
    segmentation = Segmentation(options=result.best.options)
    flags = flags_for(segmentation)
    say(f"as flags: {flags}" if flags else "the model works best with its own values: no settings are needed")
    if output is not None:
        write_text(output, settings_file(segmentation, f"picked by actum tune for model {loaded.id}"))
        say(f"written to {output}: set ACTUM_CONFIG={output} to use it")


def flags_for(segmentation: Segmentation) -> str:
    """Write the settings that are not as by default as flags for a shell; "" where all are."""
    flags = []
    for name, value in _set(segmentation):
        parts = [f"{action}={seconds:g}" for action, seconds in value.items()] if isinstance(value, dict) else value
        flags.append(f"{flag_of(name)}={_as_csv(parts) if isinstance(parts, list) else parts}")
    return shlex.join(flags)


def settings_file(segmentation: Segmentation, origin: str) -> str:
    """Write the settings that are not as by default as a file for `ACTUM_CONFIG`; its first line says their origin."""
    lines = [f"{name} = {_as_toml(value)}" for name, value in _set(segmentation)]
    return "\n".join([f"# {origin}", *(lines or ["# the model does best as it is: nothing is to be set"]), ""])


def refuse_other_settings(file: Path) -> None:
    """Fail where a file that is to be written holds what is none of these settings."""
    try:
        held = tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    except (tomllib.TOMLDecodeError, UnicodeDecodeError):
        fail(f"{file} already exists and is not a TOML file: give another file")
    except OSError as error:
        fail(str(error))
    if others := sorted(held.keys() - set(SEARCH_SETTINGS)):
        fail(
            f"{file} also sets {', '.join(others)}, which would be lost if the file were overwritten: write to "
            f"another file, then copy the new lines into {file}"
        )


def _set(segmentation: Segmentation) -> Iterator[tuple[str, float | dict[str, float] | list[str]]]:
    """Yield name and value of each setting that is not as by default."""
    options = segmentation.options
    values = (
        options.false_alarms_per_min,
        options.shortest_pause_s,
        dict(options.cooldown_s),
        sorted(segmentation.enabled),
        sorted(options.disabled),
    )
    yield from ((name, value) for name, value in zip(SEARCH_SETTINGS, values, strict=True) if value)


def _as_csv(names: list[str]) -> str:
    row = StringIO()
    csv.writer(row, lineterminator="").writerow(names)
    return row.getvalue()


def _as_toml(value: float | str | dict[str, float] | list[str]) -> str:
    """Write a value in TOML, whose strings are JSON's."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_as_toml(name)} = {seconds}' for name, seconds in value.items())}}}"
    return json.dumps(value, ensure_ascii=False)
