"""`actum train` and `actum evaluate`."""

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
from actum_command.commands.terminal import console, fail, failing_on, refuse_unwritable, say, write_text
from actum_command.commands.tune_command import SEARCH_SETTINGS, flags_for
from actum_command.service_settings import Given, arguments_of, flag_of
from actum_model_trainer.advice import Contents, advice
from actum_model_trainer.background import shipped
from actum_model_trainer.continuous.continuous_report import continuous_report
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import NoSpotterError, found_by
from actum_model_trainer.continuous_cross_validation import found_without_each, models_without
from actum_model_trainer.cross_validation import leave_one_person_out
from actum_model_trainer.evaluation import evaluate
from actum_model_trainer.report import report
from actum_model_trainer.samples import LabelledStream, Samples, samples_from, select
from actum_model_trainer.sampling import sampled_from
from actum_model_trainer.side_by_side import at_most
from actum_model_trainer.training import TrainingError, add_to, train_to_spot, with_continuation
from som_classifier.attention import ATTENTIONS, MOVING
from som_classifier.model import Arrays, Model
from som_classifier.model_loading import ModelError, kept_in, load_model
from som_classifier.presets import DEFAULT, PAPER, PRESETS, Preset
from som_classifier.segmentation import Segmentation
from som_classifier.settings import Settings

CLASSIFIER = "som_classifier"
"""The service that has the settings of the search."""
Files = Annotated[list[Path], typer.Argument(help="recordings, or folders of recordings")]
PRESET_HELP = (
    f"kind of model to train: {PAPER.name} is the method of the paper that actum implements (Gharaee et al. 2017); "
    f"{DEFAULT.name} is more accurate"
)
SET_HELP = (
    f"change a setting of --preset {PAPER.name}; may be repeated. Settings: axes=upright (of the person's coordinate "
    "axes, one is vertical and the others turn smoothly with the body; default) or axes=posture (all axes turn with "
    "the body, computed anew in each frame); "
    "origin=torso (positions are measured from the torso; default) or origin=hips; attention=PART, the body part whose "
    f"joints are used: {', '.join(part for part in ATTENTIONS if part != MOVING)} or {MOVING} (the part that moves "
    "most; default)"
)
SEED_HELP = "seed of the random numbers of the training; the same seed and recordings give the same model"
BACKGROUND_HELP = (
    "examples of movement that the model learns to ignore. 'shipped' (default): half an hour of simulated people, "
    "supplied with actum; 'none': no examples; otherwise a recording (.mcap) or a folder of recordings. May be repeated"
)
SHIPPED, NONE = "shipped", "none"
ONLY_LEFT_OUT = "used only with --leave-one-person-out: "
PRESETS_SHOWN = f"<{'|'.join(PRESETS)}>"
PresetOption = Annotated[str, typer.Option(metavar=PRESETS_SHOWN, help=PRESET_HELP)]
SetOption = Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)]
SeedOption = Annotated[int, typer.Option(min=0, help=SEED_HELP)]
JOBS_HELP = (
    "parts of a training that run at the same time; each takes memory. Default: the number of processors. The model is "
    "the same with any number"
)
ADD_TO_HELP = (
    "add the recorded examples to this model, which keeps its maps, instead of training a new one. The recordings may "
    "show new actions or known ones. Takes about a second"
)

CONTINUE_HELP = (
    "also train the prediction of how a person's posture goes on in the next second. Takes some seconds, and makes the "
    "model file larger"
)


def train_command(  # noqa: PLR0913, PLR0917 - one parameter is one option
    context: typer.Context,
    files: Files,
    output: Annotated[Path, typer.Option("-o", "--output", help="the model file to write (.npz)")],
    preset: PresetOption = DEFAULT.name,
    settings: SetOption = None,
    person: PersonOption = None,
    seed: SeedOption = 0,
    with_excluded: AllOption = False,
    background: Annotated[
        list[str] | None, typer.Option(metavar=f"<{SHIPPED}|{NONE}|FILE>", help=BACKGROUND_HELP)
    ] = None,
    add_to_model: Annotated[Path | None, typer.Option("--add-to", metavar="MODEL", help=ADD_TO_HELP)] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help=JOBS_HELP)] = None,
    continued: Annotated[bool, typer.Option("--continue", help=CONTINUE_HELP)] = False,
) -> None:
    """Train a model on labelled recordings, and write it to a file for 'actum up --model'."""
    began_s = time.monotonic()
    _refuse_place(output, ".npz")
    chosen_preset = preset_named(preset, settings or ())
    known = None if add_to_model is None else _known(add_to_model, context)
    recordings = chosen(files, person, with_excluded)
    with failing_on(RecordingError, TrainingError, ModelError, OSError), at_most(jobs):
        samples = _read(recordings)
        with bars() as progress:
            if known is None:
                beside = _background(background or [SHIPPED])
                model = train_to_spot(samples.usable, samples.streams, chosen_preset, seed, progress, beside)
                model = with_continuation(model, samples.streams, seed, progress) if continued else model
            else:
                model = add_to(*known, samples.usable, samples.streams, seed, progress)
        model.save(output)
    say(
        f"model {model.id}: {model.metadata.samples} samples of {len(model.labels)} actions, preset "
        f"{model.metadata.preset}, {time.monotonic() - began_s:.1f} s, written to {output}"
    )
    if known is None:
        _advise(samples, model)


def _known(path: Path, context: typer.Context) -> tuple[Model, Arrays]:
    """Return the model of `--add-to`, and what its file keeps; fail where a flag asks for something else."""
    flags = {"preset": "--preset", "settings": "--set", "background": "--background", "continued": "--continue"}
    sources = {flag: context.get_parameter_source(name) for name, flag in flags.items()}
    given = [flag for flag, source in sources.items() if source is not None and source.name != "DEFAULT"]
    if given:
        kept = "preset, settings, background and continuation"
        fail(f"--add-to keeps the model's {kept}: leave out {' and '.join(given)}")
    with failing_on(ModelError):
        return load_model(path), kept_in(path)


def _read(recordings: Sequence[Recording]) -> Samples:
    """Read the examples, and print which cannot be used."""
    with bars() as progress:
        sampling = sampled_from(recordings, progress)
    samples = sampling.samples
    if remark := sampling.remark:
        say(remark)
    for unusable in samples.unusable:
        say(f"{unusable.segment_id} of {unusable.file} was not used: {unusable.reason}")
    tell_unread(recordings)
    return samples


def _advise(samples: Samples, model: Model) -> None:
    """Print what to record next."""
    contents = Contents.of(samples.usable, model.background_s or 0.0)
    for sentence in advice(contents, model.metadata.held_out_answers):
        say(sentence, style="yellow")


def _background(names: Sequence[str]) -> list[LabelledStream]:
    """Return the streams of `--background`: those that come with actum, and those of recordings."""
    files = select([Path(name) for name in names if name not in (SHIPPED, NONE)])
    return [*(shipped() if SHIPPED in names else ()), *samples_from(files).streams]


@with_flags_of(CLASSIFIER, names=SEARCH_SETTINGS)
def evaluate_command(  # noqa: PLR0913, PLR0917 - one parameter is one option
    given: Given,
    files: Annotated[
        list[Path],
        typer.Argument(
            help=(
                "the model file to test (none with --leave-one-person-out), then labelled recordings or folders "
                "of recordings"
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
                "test without a model file: for each person in turn, train a model on all other people and test it on "
                "this person"
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
    preset: Annotated[str, typer.Option(metavar=PRESETS_SHOWN, help=ONLY_LEFT_OUT + PRESET_HELP)] = DEFAULT.name,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=ONLY_LEFT_OUT + SET_HELP)
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help=ONLY_LEFT_OUT + SEED_HELP)] = 0,
    with_excluded: AllOption = False,
    jobs: Annotated[int | None, typer.Option(min=1, help=ONLY_LEFT_OUT + JOBS_HELP)] = None,
) -> None:
    """Test how well actions are recognised in labelled recordings, and print the scores.

    Name a model file to test that model, or use --leave-one-person-out to learn how well a model works with new people.
    """
    if json_file is not None:
        _refuse_place(json_file, ".json")
    if not by_person and len(files) == 1:
        fail(
            f"a model and at least one recording are needed, but only {files[0]} was given: give both, or use "
            "--leave-one-person-out with recordings alone"
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
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_json() | {"scores": scores.as_json()}, indent=1))


def segmentation_of(given: Given) -> Segmentation:
    """Return the search settings of a classifier with these flags, and of the environment and `ACTUM_CONFIG`.

    Fail where the settings cannot be used.
    """
    try:
        settings = from_command_line(Settings, CLASSIFIER, arguments_of(CLASSIFIER, given))
    except ValueError as error:
        fail(complaint(error))
    return replace(settings.segmentation, segments="auto")


def preset_named(name: str, settings: Sequence[str]) -> Preset:
    """Return the preset of a name, changed by the settings, each NAME=VALUE; fail where there is no such preset."""
    if name not in PRESETS:
        fail(f"{name!r} is not a preset: use one of {', '.join(PRESETS)}")
    preset = PRESETS[name]
    changes = dict(setting.partition("=")[::2] for setting in settings)
    if changes and not preset.choices:
        fail(
            f"preset {name} has no settings: leave out --set, or use --preset {PAPER.name}, which has the settings "
            f"{', '.join(PAPER.choices)}"
        )
    for setting, value in changes.items():
        if value not in preset.choices.get(setting, ()):
            known = "; ".join(f"{each}={'|'.join(values)}" for each, values in preset.choices.items())
            fail(f"{setting}={value} is not a setting of preset {name}: use one or more of {known}")
    return preset.changed(changes) if changes else preset


def _refuse_place(file: Path, ending: str) -> None:
    """Fail before long work where its result could not be written."""
    if not file.parent.is_dir():
        fail(f"{file} cannot be written: the folder {file.parent} does not exist")
    refuse_unwritable(file, ending)
