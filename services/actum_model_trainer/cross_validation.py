"""Leave-one-person-out cross-validation: how well a model recognises people it was not trained on."""

from collections.abc import Iterator, Mapping, Sequence

from actum.recording import Recording
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.evaluation import Evaluation, Prediction, prediction, segment_labels
from actum_model_trainer.progress import Progress, prefixed, silent
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.recorded_segments import sensors
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample, Unusable
from actum_model_trainer.training import train
from som_classifier.model import Model
from som_classifier.presets import Preset

SegmentsById = Mapping[tuple[str, str, str], SegmentSample | Unusable]
"""The first segment of each file, sensor and segment id."""


def people_of(recordings: Sequence[Recording]) -> list[str]:
    """List the people whom recordings name, sorted.

    Raises:
        TrainingError: fewer than two.
    """
    people = sorted({recording.person for recording in recordings})
    if len(people) < 2:
        known = f"only {people[0]}" if any(people) else "nobody whose name is known"
        raise TrainingError(
            "each person is tested with a model that was trained on other people, so recordings of at least two "
            f"people are needed. The given recordings show {known}: record another person with --person NAME"
        )
    return people


def leave_one_person_out(
    recordings: Sequence[Recording], preset: Preset, seed: int = 0, progress: Progress = silent
) -> Evaluation:
    """Test each person on a model trained on all others, and pool the predictions.

    The recordings are replayed only once. The answers to the samples cut out of them equal those of the live
    classifier, to the bit.

    Raises:
        TrainingError: fewer than two persons, or the others' samples make no model.
        RecordingError: a file is damaged.
    """
    people = people_of(recordings)
    samples = samples_from(recordings, progress)
    segments: dict[tuple[str, str, str], SegmentSample | Unusable] = {}
    for segment in samples.segments:
        segments.setdefault((segment.file, segment.sensor, segment.segment_id), segment)
    predictions: list[Prediction] = []
    for person in people:
        others = [sample for sample in samples.usable if sample.person != person]
        model = train(others, preset, seed, prefixed(f"without {person or 'unnamed'}: ", progress))
        tests = [recording for recording in recordings if recording.person == person]
        predictions += _predictions(model, tests, segments, prefixed(f"on {person or 'unnamed'}: ", progress))
    return Evaluation(tuple(predictions))


def _predictions(
    model: Model, recordings: Sequence[Recording], segments: SegmentsById, progress: Progress
) -> Iterator[Prediction]:
    for done, recording in enumerate(recordings):
        progress("evaluating", done, len(recordings))
        for sensor in sensors(recording):
            for segment_id, label in segment_labels(recording, sensor).items():
                file = str(recording.path)
                segment = segments.get((file, sensor, segment_id))
                answered = answer(model, encoded(model, segment)) if isinstance(segment, SegmentSample) else None
                yield prediction(file, segment_id, label, answered.label if answered else None, answered)
    progress("evaluating", len(recordings), len(recordings))
