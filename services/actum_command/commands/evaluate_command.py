"""`actum evaluate`."""

import json
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from actum.command_line import from_command_line
from actum.recording import Recording, RecordingError
from actum.settings import complaint
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.service_flags import with_flags_of
from actum_command.commands.terminal import console, fail, failing_on, say, write_text
from actum_command.commands.training_commands import (
    JOBS_HELP,
    PRESET_HELP,
    PRESETS_SHOWN,
    SEED_HELP,
    SET_HELP,
    flags_given,
    preset_named,
    refuse_place,
)
from actum_command.commands.tune_command import SEARCH_SETTINGS, flags_for
from actum_command.service_settings import Given, arguments_of, flag_of
from actum_model_trainer.continuous.continuous_report import continuous_report
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import NoSpotterError, found_by, views_of
from actum_model_trainer.continuous_cross_validation import found_without_each, models_without
from actum_model_trainer.cross_validation import leave_one_person_out
from actum_model_trainer.evaluation import evaluate
from actum_model_trainer.foreseeing.intent_report import intent_report
from actum_model_trainer.foreseeing.intent_scores import intent_scores
from actum_model_trainer.foreseeing.recorded import recorded_in
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.report import report
from actum_model_trainer.side_by_side import at_most
from actum_model_trainer.tuning.doubts import of_test
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, load_model
from som_classifier.presets import DEFAULT, Preset
from som_classifier.segmentation import Segmentation
from som_classifier.settings import Settings

CLASSIFIER = "som_classifier"
"""The service that has the settings of the search."""
ONLY_LEFT_OUT = ". Used only with --leave-one-person-out"
INTENT_HELP = (
    "test, without a model file, how early and how correctly actum predicts which object a hand will touch. The "
    "recordings must contain tracked objects. An object counts as touched when it first moves during a labelled action"
)
OF_MODELS = {
    "continuous": "--continuous",
    "by_person": "--leave-one-person-out",
    "preset": "--preset",
    "settings": "--set",
    "seed": "--seed",
    "jobs": "--jobs",
}
"""The options, by parameter, that mean nothing to intents."""


@with_flags_of(CLASSIFIER, names=SEARCH_SETTINGS)
def evaluate_command(  # noqa: PLR0913, PLR0917 - one parameter is one option
    context: typer.Context,
    given: Given,
    files: Annotated[
        list[Path],
        typer.Argument(
            help=(
                "the model file to test, then labelled recordings or folders of recordings. With "
                "--leave-one-person-out or --intent, name only recordings or folders"
            )
        ),
    ],
    person: PersonOption = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="also write every prediction to this file (.json)")
    ] = None,
    by_person: Annotated[
        bool,
        typer.Option(
            "--leave-one-person-out",
            help=(
                "test without a model file: for each person in turn, train a model on all other people, and test this "
                "model on the person"
            ),
        ),
    ] = False,
    continuous: Annotated[
        bool,
        typer.Option(
            "--continuous",
            help=(
                "test whether the model finds the actions by itself; default: the model is given the start and end of "
                "each labelled action"
            ),
        ),
    ] = False,
    intent: Annotated[bool, typer.Option("--intent", help=INTENT_HELP)] = False,
    preset: Annotated[str, typer.Option(metavar=PRESETS_SHOWN, help=PRESET_HELP + ONLY_LEFT_OUT)] = DEFAULT.name,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP + ONLY_LEFT_OUT)
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help=SEED_HELP + ONLY_LEFT_OUT)] = 0,
    with_excluded: AllOption = False,
    jobs: Annotated[int | None, typer.Option(min=1, help=JOBS_HELP + ONLY_LEFT_OUT)] = None,
) -> None:
    """Test how well actions are recognised in labelled recordings, and print the scores.

    To test one model, name its file. To learn how well a model would work with new people, use --leave-one-person-out.
    """
    if json_file is not None:
        refuse_place(json_file, ".json")
    if intent:
        _refuse_with_intent(context, given)
        _evaluate_intents(chosen(files, person, with_excluded), json_file)
        return
    if not by_person and len(files) == 1:
        fail(
            f"a model and at least one recording are needed, but only {files[0]} was given: give both, or give only "
            "recordings and add --leave-one-person-out"
        )
    with failing_on(ModelError):
        model = None if by_person else load_model(files[0])
    if given and not continuous:
        fail(f"{flag_of(next(iter(given)))} works only together with --continuous: add --continuous")
    recordings = chosen(files if by_person else files[1:], person, with_excluded)
    what = model, recordings, preset_named(preset, settings or ()), seed, json_file
    with at_most(jobs):
        if continuous:
            _evaluate_continuously(*what, segmentation_of(given))
        else:
            _evaluate_segments(*what)


def _evaluate_segments(
    model: Model | None, recordings: Sequence[Recording], preset: Preset, seed: int, json_file: Path | None
) -> None:
    """Recognise labelled segments by a model, or without one each person's by all others, and print the scores."""
    began_s = time.monotonic()
    with failing_on(RecordingError, TrainingError), bars() as progress:
        if model is None:
            result = leave_one_person_out(recordings, preset, seed, progress)
        else:
            result = evaluate(model, recordings, progress)
    tell_unread(recordings)
    if result.n == 0:
        fail(
            "the given recordings contain no labelled action: record with 'actum record --label', or label the "
            "recordings with 'actum label'"
        )
    console.print(report(result, time.monotonic() - began_s))
    people = {str(each.path): each.person for each in recordings}
    for doubt in of_test(model, people, [(each.label, each.file) for each in result.predictions]):
        say(doubt, style="yellow")
    if json_file is not None:
        write_text(json_file, json.dumps(result.as_json(), indent=1))


def _evaluate_continuously(
    model: Model | None,
    recordings: Sequence[Recording],
    preset: Preset,
    seed: int,
    json_file: Path | None,
    segmentation: Segmentation,
) -> None:
    """Watch recordings with a model, or without one each person with one of all others, and print the scores."""
    began_s = time.monotonic()
    if model is not None and (problem := segmentation.misnamed(model)):
        fail(problem)
    if flags := flags_for(segmentation):
        say(f"with {flags}")
    with failing_on(RecordingError, TrainingError, NoSpotterError), bars() as progress:
        if model is None:
            models = models_without(recordings, preset, seed, progress)
            found = found_without_each(recordings, models, progress, segmentation)
        else:
            found = found_by(model, recordings, progress, segmentation)
    tell_unread(recordings)
    if not found.seen:
        fail("the given recordings contain no skeletons: give recordings of a person")
    scores = scores_of(found)
    console.print(continuous_report(scores, time.monotonic() - began_s))
    people = {file: each.person for each in recordings for _, file in views_of(each)}
    for doubt in of_test(model, people, [(each.label, each.file) for each in found.truths]):
        say(doubt, style="yellow")
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_json() | {"scores": scores.as_json()}, indent=1))


def _refuse_with_intent(context: typer.Context, given: Given) -> None:
    """Fail where an option is given that has to do with models of actions, of which intents need none."""
    if flags := [*flags_given(context, OF_MODELS), *map(flag_of, given)]:
        fail(
            f"--intent does not use a model of actions, so {' and '.join(flags)} would have no effect: leave out "
            f"{' and '.join(flags)}"
        )


def _evaluate_intents(recordings: Sequence[Recording], json_file: Path | None) -> None:
    """Foresee the contacts in recordings, and print the scores."""
    began_s = time.monotonic()
    with failing_on(RecordingError), bars() as progress:
        recorded = recorded_in(recordings, progress)
        scores = intent_scores(recorded, progress) if recorded.contacts else None
    tell_unread(recordings)
    if not recorded.takes:
        fail(
            "the given recordings show no person and tracked object at the same time: record while objects are tracked"
        )
    if scores is None:
        fail(
            f"the given recordings contain no contact of a hand with an object ({recorded.without_contact} labelled "
            "actions, all without contact): "
            "record labelled actions in which a hand moves an object"
        )
    console.print(intent_report(scores, time.monotonic() - began_s))
    if json_file is not None:
        write_text(json_file, json.dumps(scores.as_json(), indent=1))


def segmentation_of(given: Given) -> Segmentation:
    """Return the search settings of a classifier with these flags, and of the environment and `ACTUM_CONFIG`.

    Fail where the settings cannot be used.
    """
    try:
        settings = from_command_line(Settings, CLASSIFIER, arguments_of(CLASSIFIER, given))
    except ValueError as error:
        fail(complaint(error))
    return replace(settings.segmentation, segments="auto")
