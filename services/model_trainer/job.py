"""The process of a job: `python -m model_trainer.job`, told what to do by one argument, JSON.

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
from actum.installing import adding
from actum.recording import Recording, RecordingError
from actum.runtime.stopping import end_with_parent
from actum_examples.take import read_take
from actum_model_trainer.advice import Contents, advice
from actum_model_trainer.continuous.watching import NoSpotterError
from actum_model_trainer.samples import Samples, samples_from, select
from actum_model_trainer.training import TrainingError, train_to_spot
from model_trainer.set_evaluation import evaluate_set
from som_classifier.model import Model
from som_classifier.presets import PRESETS

TELL_S = 0.1
"""Shortest time between two lines of one stage (s): the page shows no more."""
MODEL, TAKE = "model.npz", "take.mcap"
"""What a job leaves in its folder."""


class Told(BaseModel):
    """What a job is told: what to do, where to write, and the fields that each kind of job needs."""

    kind: str
    folder: Path
    takes: Path = Path()
    preset: str = ""
    seed: int = 0
    video: Path = Path()
    label: str = ""
    person: str = ""
    count: int | None = None
    created: str = ""


class Teller:
    """Prints progress."""

    def __init__(self) -> None:
        self._stage = ""
        self._next_s = 0.0

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Print how far a stage is, unless that was told a moment ago."""
        now_s = time.monotonic()
        if stage != self._stage or now_s >= self._next_s:
            self._stage, self._next_s = stage, now_s + TELL_S
            tell(stage=stage, done=min(done / total, 1.0) if total else 0.0)


def tell(**fields: Any) -> None:
    """Print one line."""
    print(json.dumps(fields), flush=True)


def train(told: Told, teller: Teller) -> dict[str, Any]:
    """Train a model on a set; it lies in the folder afterwards."""
    samples = _samples(told, teller)
    model = train_to_spot(samples.usable, samples.streams, PRESETS[told.preset], told.seed, teller)
    model.save(told.folder / MODEL)
    answers = model.metadata.held_out_answers
    right = sum(done == answered for done, answered in answers)
    return {
        "model": model.id,
        "labels": model.labels,
        "examples": len(samples.usable),
        "left_out": [f"{each.segment_id}: {each.reason}" for each in samples.unusable],
        "scores": {"accuracy_held_out": right / len(answers)} if answers else {},
        "advice": advice(_contents(told, model), answers),
    }


def evaluate(told: Told, teller: Teller) -> dict[str, Any]:
    """Cross-validate a set, and say what to record next."""
    recordings = select([_snapshot(told)])
    result = evaluate_set(recordings, PRESETS[told.preset], told.seed, teller)
    answers = [(each.label, each.predicted) for each in result.marked.predictions if each.predicted is not None]
    return {**result.as_json(), "advice": advice(_contents(told, None), answers, result.found)}


def import_video(told: Told, teller: Teller) -> dict[str, Any]:
    """Find the person in a video, and cut the examples out; the take lies in the folder afterwards."""
    from model_trainer.video_take import take_of_video  # its libraries are heavy, and may be missing

    examples, doubts = take_of_video(
        told.video, told.folder / TAKE, told.label, told.person, told.count, told.created, teller
    )
    return {"examples": examples, "doubts": doubts}


def main() -> None:
    """Do the job that the argument tells."""
    end_with_parent()
    told = Told.model_validate_json(sys.argv[1])
    jobs: dict[str, Callable[[Told, Teller], dict[str, Any]]] = {
        "train": train,
        "evaluate": evaluate,
        "import": import_video,
    }
    try:
        tell(result=jobs[told.kind](told, Teller()))
    except (Refusal, TrainingError, RecordingError, NoSpotterError, OSError) as error:
        tell(error=str(error))
    except ModuleNotFoundError as error:
        tell(error=f"{error.name} is not installed: {adding('camera')}")


def _samples(told: Told, teller: Teller) -> Samples:
    return samples_from(select([_snapshot(told)]), teller)


def _snapshot(told: Told) -> Path:
    """Return a folder with the set as it is now, whatever is mended while the job runs: files are replaced whole."""
    snapshot = told.folder / "takes"
    snapshot.mkdir()
    for take in sorted(told.takes.glob("*.mcap")):
        try:
            os.link(take, snapshot / take.name)
        except OSError:  # a file system without hard links
            shutil.copyfile(take, snapshot / take.name)
    return snapshot


def _contents(told: Told, model: Model | None) -> Contents:
    """Return what the set holds, as it was when the job began."""
    takes = [read_take(Recording(path)) for path in sorted((told.folder / "takes").glob("*.mcap"))]
    background_s = sum(take.background_s for take in takes)
    return Contents(
        dict(sorted(Counter(label for take in takes for label in take.labels).items())),
        frozenset(take.person for take in takes if take.examples),
        background_s if model is None else model.background_s or 0.0,
        Counter(each.label for take in takes for each in take.examples if each.doubts and each.label),
    )


if __name__ == "__main__":
    main()
