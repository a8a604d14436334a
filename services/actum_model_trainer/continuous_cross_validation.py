"""Leave-one-person-out in whole recordings: how well actions of people who were not trained on are found."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from actum.recording import Recording
from actum_model_trainer.continuous.detections import Detection, Found, point_fractions
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.cross_validation import people_of
from actum_model_trainer.progress import Progress, prefixed, silent
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train_to_spot
from som_classifier.model import Model
from som_classifier.presets import Preset
from som_classifier.segmentation import DEFAULT, Segmentation

ModelWithout = Callable[[str, Progress], Model]
"""Trains a model on everybody but one person."""


def models_without(
    recordings: Sequence[Recording], preset: Preset, seed: int = 0, progress: Progress = silent
) -> ModelWithout:
    """Read recordings once, and return what trains on all people in them but one.

    Raises:
        RecordingError: a file is damaged.
    """
    samples = samples_from(recordings, progress)

    def model_without(person: str, progress: Progress) -> Model:
        others = [sample for sample in samples.usable if sample.person != person]
        streams = [stream for stream in samples.streams if stream.person != person]
        return train_to_spot(others, streams, preset, seed, progress)

    return model_without


def found_without_each(
    recordings: Sequence[Recording],
    model_without: ModelWithout,
    progress: Progress = silent,
    segmentation: Segmentation = DEFAULT,
) -> Found:
    """Watch each person with a model trained on all others, and with these settings; pool what is found.

    Where the recordings have action points, those of the others say where in a detection its own is claimed.

    Raises:
        TrainingError: fewer than two persons, or the others' samples make no model.
        NoSpotterError: a model cannot find actions without marks.
        RecordingError: a file is damaged.
    """
    found: dict[str, Found] = {}
    for person in people_of(recordings):
        model = model_without(person, prefixed(f"without {person or 'unnamed'}: ", progress))
        own = [recording for recording in recordings if recording.person == person]
        found[person] = found_by(model, own, prefixed(f"on {person or 'unnamed'}: ", progress), segmentation)
    return sum((_with_points(person, found) for person in found), Found())


def with_points(detections: Iterable[Detection], fractions: Mapping[str, float]) -> list[Detection]:
    """Let detections claim the action point at a fraction (0 to 1) of their length, by label; else in the middle."""
    return [
        replace(own, point_ns=own.start_ns + round(fractions.get(own.label, 0.5) * (own.end_ns - own.start_ns)))
        for own in detections
    ]


def _with_points(person: str, found: Mapping[str, Found]) -> Found:
    fractions = point_fractions(truth for other, own in found.items() if other != person for truth in own.truths)
    own = found[person]
    return replace(own, detections=with_points(own.detections, fractions)) if fractions else own
