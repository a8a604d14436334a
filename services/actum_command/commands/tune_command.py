"""`actum tune`: picks the settings of the search for actions from labelled continuous recordings."""

import time
from pathlib import Path
from typing import Annotated

import typer

from actum.recording import RecordingError
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import console, fail, refuse_ending, refuse_unwritable, say, write_text
from actum_command.search_settings import OtherSettingsError, flags_for, refuse_other_settings, settings_file
from actum_model_trainer.continuous.watching import NoSpotterError
from actum_model_trainer.tuning.tuning import NothingLabelledError, tuned
from actum_model_trainer.tuning.tuning_report import tuning_report
from som_classifier.model_loading import ModelError, load_model
from som_classifier.segmentation import Segmentation


def tune(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="the model file to tune")],
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="REC...",
            help=(
                "recordings, or folders of recordings, in which all actions are labelled and people also do other "
                "things between the actions"
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
                "the file to write the chosen settings to (.toml); services read this file if ACTUM_CONFIG is set to "
                "its path. Default: the settings are only printed"
            ),
        ),
    ] = None,
    person: PersonOption = None,
    with_excluded: AllOption = False,
) -> None:
    """Choose the settings with which a model best finds actions by itself, and print the settings and their effect.

    The command chooses --false-alarms-per-min, --shortest-pause-s, --cooldown-s and --disabled-actions of the
    classifier.
    """
    began_s = time.monotonic()
    if false_alarms_per_min is not None and not 0 < false_alarms_per_min < float("inf"):
        fail(f"--false-alarms-per-min is {false_alarms_per_min:g}; it has to be a number above 0")
    if output is not None:
        _refuse(output)
    try:
        loaded = load_model(model)
        recordings = chosen(files, person, with_excluded)
        with bars() as progress:
            result = tuned(loaded, recordings, false_alarms_per_min, progress)
    except (ModelError, RecordingError, NoSpotterError, NothingLabelledError) as error:
        fail(str(error))
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


def _refuse(output: Path) -> None:
    """Fail before long work where its result could not be written."""
    refuse_unwritable(output)
    refuse_ending(output, ".toml")
    try:
        refuse_other_settings(output)
    except (OtherSettingsError, OSError) as error:
        fail(str(error))
