"""`actum train`."""

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer

from actum.recording import Recording, RecordingError
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import fail, failing_on, refuse_unwritable, say
from actum_model_trainer.advice import Contents, advice
from actum_model_trainer.background import shipped
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.sample_reading import samples_from, select
from actum_model_trainer.samples import LabelledStream, Samples
from actum_model_trainer.sampling import sampled_from
from actum_model_trainer.side_by_side import at_most
from actum_model_trainer.training import add_to, train_to_spot, with_continuation
from som_classifier.attention import ALL, MOVING, PART_NAMES
from som_classifier.model import Arrays, Model
from som_classifier.model_loading import ModelError, kept_in, load_model
from som_classifier.presets import DEFAULT, PAPER, PRESETS, Preset

Files = Annotated[list[Path], typer.Argument(help="recordings, or folders of recordings")]
*LIMBS, TRUNK = PART_NAMES
PRESET_HELP = (
    f"kind of model to train. {PAPER.name}: the method of the paper that actum implements (Gharaee et al. 2017). "
    f"{DEFAULT.name} (default): a more accurate method"
)
SET_HELP = (
    f"change a setting of the preset '{PAPER.name}' (--preset {PAPER.name}); the option can be repeated. "
    "axes=upright (default): one coordinate axis stays vertical, and the other axes turn smoothly with the person. "
    "axes=posture: all axes turn with the person in each frame. origin=torso (default) or origin=hips: the point "
    f"from which positions are measured. attention={MOVING} (default): use only the joints of the body part that moves "
    f"most. attention={ALL}: use all joints. attention={', '.join(LIMBS[:-1])} or {LIMBS[-1]}: use only the joints of "
    f"this limb. attention={TRUNK}: use only head, neck and torso"
)
SEED_HELP = "seed of the random numbers of the training; the same seed and recordings give the same model"
BACKGROUND_HELP = (
    "examples of background activity, which the model learns to ignore. shipped (default): half an hour of simulated "
    "people, supplied with actum. none: no examples. FILE: a recording (.mcap) or a folder of recordings. The option "
    "can be repeated"
)
SHIPPED, NONE = "shipped", "none"
PRESETS_SHOWN = f"<{'|'.join(PRESETS)}>"
PresetOption = Annotated[str, typer.Option(metavar=PRESETS_SHOWN, help=PRESET_HELP)]
SetOption = Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)]
SeedOption = Annotated[int, typer.Option(min=0, help=SEED_HELP)]
JOBS_HELP = (
    "number of threads for training. With more threads, training is faster but takes more memory; the trained model is "
    "the same. Default: one thread per processor"
)
ADD_TO_HELP = (
    "add the examples in the recordings to this model, instead of training a new model. The examples can show new "
    "actions, or actions that the model knows already. The model's self-organizing maps do not change. Adding the "
    "examples takes about a second"
)

CONTINUE_HELP = (
    "also train a prediction of the person's posture in the next second. This prediction takes some seconds to train, "
    "and makes the model file larger"
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
    """Train a model on labelled recordings, and write the model to a file for 'actum up --model'."""
    began_s = time.monotonic()
    refuse_place(output, ".npz")
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
    given = flags_given(context, flags)
    if given:
        fail(
            "with --add-to, the model keeps its preset, settings, background and continuation: leave out "
            f"{' and '.join(given)}"
        )
    with failing_on(ModelError):
        return load_model(path), kept_in(path)


def flags_given(context: typer.Context, flags: Mapping[str, str]) -> list[str]:
    """Return those flags, by the command's parameter, that somebody gave."""
    sources = {flag: context.get_parameter_source(name) for name, flag in flags.items()}
    return [flag for flag, source in sources.items() if source is not None and source.name != "DEFAULT"]


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


def refuse_place(file: Path, ending: str) -> None:
    """Fail before long work where its result could not be written."""
    if not file.parent.is_dir():
        fail(
            f"{file} cannot be written: the folder {file.parent} does not exist. Create this folder, or give another "
            "file"
        )
    refuse_unwritable(file, ending)
