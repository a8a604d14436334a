"""How often an action is recognised of people of whom no example was trained."""

from collections.abc import Iterator, Mapping, Sequence

from actum.recording import Recording
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.evaluation import Evaluation, Prediction, labels_of, prediction
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.samples import SegmentSample, Unusable, samples_from, sensors
from actum_model_trainer.training import TrainingError, train
from som_classifier.model import Model
from som_classifier.presets import Preset

Cut = Mapping[tuple[str, str, str], SegmentSample | Unusable]
"""What the first segment of a file, a sensor and an id holds."""


def leave_one_person_out(
    recordings: Sequence[Recording], preset: Preset, seed: int = 0, progress: Progress = silent
) -> Evaluation:
    """Test each person on a model trained on all others, and pool the predictions.

    The recordings are replayed once; from then on the answers to what was cut out of them are those of a live
    classifier, to the bit.

    Raises:
        TrainingError: fewer than two persons, or the others' samples make no model.
        RecordingError: a file is damaged.
    """
    people = sorted({recording.person for recording in recordings})
    if len(people) < 2:
        raise TrainingError(f"recordings of at least two persons are needed; these are of {people or 'none'}")
    samples = samples_from(recordings, progress)
    cut: dict[tuple[str, str, str], SegmentSample | Unusable] = {}
    for segment in samples.segments:
        cut.setdefault((segment.file, segment.sensor, segment.segment_id), segment)
    predictions: list[Prediction] = []
    for person in people:
        others = [sample for sample in samples.usable if sample.person != person]
        model = train(others, preset, seed, _prefixed(f"without {person or 'unnamed'}: ", progress))
        own = [recording for recording in recordings if recording.person == person]
        predictions += _predictions(model, own, cut, _prefixed(f"on {person or 'unnamed'}: ", progress))
    return Evaluation(tuple(predictions))


def _predictions(model: Model, recordings: Sequence[Recording], cut: Cut, progress: Progress) -> Iterator[Prediction]:
    for done, recording in enumerate(recordings):
        progress("evaluating", done, len(recordings))
        for sensor in sensors(recording):
            for segment_id, label in labels_of(recording, sensor).items():
                segment = cut.get((str(recording.path), sensor, segment_id))
                found = answer(model, encoded(model, segment)) if isinstance(segment, SegmentSample) else None
                yield prediction(recording, segment_id, label, found.label if found else None, found)
    progress("evaluating", len(recordings), len(recordings))


def _prefixed(prefix: str, progress: Progress) -> Progress:
    return lambda stage, done, total: progress(prefix + stage, done, total)
