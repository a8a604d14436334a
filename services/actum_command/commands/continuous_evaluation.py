"""`actum evaluate --continuous`: how well actions are found in whole recordings without their marks."""

import json
import time
from collections.abc import Sequence
from pathlib import Path

from actum.recording import Recording, RecordingError
from actum_command.commands.progress_bars import bars
from actum_command.commands.recording_options import tell_unread
from actum_command.commands.terminal import console, fail, say, write_text
from actum_command.search_settings import flags_for
from actum_model_trainer.continuous.continuous_report import continuous_report
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import NoSpotterError, found_by
from actum_model_trainer.continuous_cross_validation import found_without_each, models_without
from actum_model_trainer.training import TrainingError
from som_classifier.model import Model
from som_classifier.presets import Preset
from som_classifier.segmentation import Segmentation


def evaluate_continuously(
    model: Model | None,
    recordings: Sequence[Recording],
    preset: Preset,
    seed: int,
    json_file: Path | None,
    segmentation: Segmentation,
) -> None:
    """Watch recordings with a model, or without one each person with one of all others, and tell the scores."""
    began_s = time.monotonic()
    if model is not None and (problem := segmentation.misnamed(model)):
        fail(problem)
    if flags := flags_for(segmentation):
        say(f"with {flags}")
    try:
        with bars() as progress:
            if model is None:
                models = models_without(recordings, preset, seed, progress)
                found = found_without_each(recordings, models, progress, segmentation)
            else:
                found = found_by(model, recordings, progress, segmentation)
    except (RecordingError, TrainingError, NoSpotterError) as error:
        fail(str(error))
    tell_unread(recordings)
    if not found.seen:
        fail("the given recordings contain no skeletons: give recordings of a person")
    scores = scores_of(found)
    console.print(continuous_report(scores, time.monotonic() - began_s))
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_json() | {"scores": scores.as_json()}, indent=1))
