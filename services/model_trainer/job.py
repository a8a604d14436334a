"""The process of a job: `python -m model_trainer.job` with one argument, the job's `Arguments` as JSON.

It prints its progress as lines of JSON: a `stage` and how much of it is `done`, at last the `result` or an `error`.
"""

import json
import os
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from actum.commands import Refusal
from actum.installing import install_command
from actum.messages import is_action
from actum.recording import Recording, RecordingError
from actum.runtime.stopping import end_with_parent
from actum_examples.take import read_take
from actum_model_trainer.advice import Contents, advice
from actum_model_trainer.continuous.watching import NoSpotterError
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.sample_reading import select
from actum_model_trainer.sampling import sampled_from
from actum_model_trainer.training import train_to_spot, update, with_continuation
from model_trainer.set_evaluation import evaluate_set
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, kept_in, load_model
from som_classifier.presets import PRESETS

PRINT_S = 0.1
"""Shortest time between two lines of one stage (s): the page shows no more."""
YIELDING = 10
"""Added to the process's niceness: on a machine that recognises meanwhile, that comes first."""
MODEL, TAKE = "model.npz", "take.mcap"
"""What a job leaves in its folder."""


SNAPSHOT = "takes"
"""The folder, in the job's, with the set as it was when the job began; errors name the set's own files."""


class Arguments(BaseModel):
    """The arguments of a job: what to do, where to write, and the fields that each kind of job needs."""

    kind: str
    folder: Path
    takes: Path = Path()
    preset: str = ""
    seed: int = 0
    continued: bool = False
    model: Path | None = None
    video: Path = Path()
    label: str = ""
    person: str = ""
    count: int | None = None
    created: str = ""


class ProgressLines:
    """Prints progress."""

    def __init__(self) -> None:
        self._stage = ""
        self._next_s = 0.0

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Print how far a stage is, unless a line of that stage was printed a moment ago."""
        now_s = time.monotonic()
        if stage != self._stage or now_s >= self._next_s:
            self._stage, self._next_s = stage, now_s + PRINT_S
            print_line(stage=stage, done=min(done / total, 1.0) if total else 0.0)


def print_line(**fields: Any) -> None:
    """Print one line."""
    print(json.dumps(fields), flush=True)


def train(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Train a model on a set, or update one; it lies in the folder afterwards."""
    before = None if arguments.model is None else load_model(arguments.model)
    sampling = sampled_from(select([_snapshot(arguments)]), progress)
    samples = sampling.samples
    learnt = samples.usable, samples.streams
    if before is None:
        model = train_to_spot(*learnt, PRESETS[arguments.preset], arguments.seed, progress)
    else:
        preset = PRESETS.get(before.metadata.preset, PRESETS[arguments.preset])
        assert arguments.model is not None
        model = update(before, *learnt, preset, arguments.seed, progress, kept_in(arguments.model))
    if arguments.continued:
        model = with_continuation(model, samples.streams, arguments.seed, progress)
    model.save(arguments.folder / MODEL)
    answers = model.metadata.held_out_answers
    right = sum(done == answered for done, answered in answers)
    return {
        "model": model.id,
        "labels": model.labels,
        "examples": len(samples.usable),
        "left_out": [f"{Path(each.file).stem}/{each.segment_id}: {each.reason}" for each in samples.unusable],
        "scores": {"accuracy_held_out": right / len(answers)} if answers else {},
        "advice": [*filter(None, [sampling.remark]), *advice(_contents(arguments, model), answers)],
    }


def evaluate(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Cross-validate a set, and say what to record next."""
    recordings = select([_snapshot(arguments)])
    result = evaluate_set(recordings, PRESETS[arguments.preset], progress)
    answers = [(each.label, each.predicted) for each in result.marked.predictions if each.predicted is not None]
    return {**result.as_json(), "advice": advice(_contents(arguments, None), answers, result.found)}


def import_video(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Find the person in a video, and cut the examples out; the take lies in the folder afterwards."""
    from model_trainer.video_take import take_of_video  # its libraries are heavy, and may be missing

    examples, doubts = take_of_video(
        arguments.video,
        arguments.folder / TAKE,
        arguments.label,
        arguments.person,
        arguments.count,
        arguments.created,
        progress,
    )
    return {"examples": examples, "doubts": doubts}


def main() -> None:
    """Do the job that the argument describes."""
    end_with_parent()
    if hasattr(os, "nice"):
        os.nice(YIELDING)
    arguments = Arguments.model_validate_json(sys.argv[1])
    jobs: dict[str, Callable[[Arguments, Progress], dict[str, Any]]] = {
        "train": train,
        "evaluate": evaluate,
        "import": import_video,
    }
    try:
        print_line(result=jobs[arguments.kind](arguments, ProgressLines()))
    except (Refusal, TrainingError, RecordingError, NoSpotterError, ModelError, OSError) as error:
        print_line(error=str(error).replace(str(arguments.folder / SNAPSHOT), str(arguments.takes)))
    except ModuleNotFoundError as error:
        print_line(error=f"{error.name} is not installed: run {install_command('camera')}")


def _snapshot(arguments: Arguments) -> Path:
    """Return a folder with the set as it is now, whatever is mended while the job runs: files are replaced whole."""
    snapshot = arguments.folder / SNAPSHOT
    snapshot.mkdir()
    for take in sorted(arguments.takes.glob("*.mcap")):
        try:
            os.link(take, snapshot / take.name)
        except OSError:  # a file system without hard links
            shutil.copyfile(take, snapshot / take.name)
    return snapshot


def _contents(arguments: Arguments, model: Model | None) -> Contents:
    """Return what the set holds, as it was when the job began."""
    takes = [read_take(Recording(path)) for path in sorted((arguments.folder / SNAPSHOT).glob("*.mcap"))]
    background_s = sum(take.background_s for take in takes)
    return Contents(
        dict(sorted(Counter(label for take in takes for label in take.labels).items())),
        frozenset(take.person for take in takes if take.labels),
        background_s if model is None else model.background_s or 0.0,
        Counter(each.label for take in takes for each in take.examples if each.doubts and is_action(each.label)),
    )


if __name__ == "__main__":
    main()
