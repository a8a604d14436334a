"""Writes a folder of pictures that explain a model and its answers to recordings, with a page that shows them."""

from collections.abc import Sequence
from pathlib import Path

from actum.recording import Recording
from actum_model_trainer.progress import Progress
from som_classifier.model import Model
from som_classifier.model_maps import NoMapsError, maps_of


class NoSegmentError(ValueError):
    """The recordings have no marked segment; the text says what to do."""


def write_inspection(
    model: Model, recordings: Sequence[Recording], folder: Path, ending: str, progress: Progress
) -> int:
    """Write pictures and page, and return how many pictures there are.

    Raises:
        NoMapsError: there are no recordings, and the model has no maps.
        NoSegmentError: there are recordings, but no marked segment in them.
        RecordingError: a recording is damaged.
        OSError: something cannot be written.
    """
    from actum_model_inspector.answered import answered_segments  # Matplotlib takes its time and need not be installed
    from actum_model_inspector.folder import PAGE, note
    from actum_model_inspector.html_page import page
    from actum_model_inspector.inspection import pictures, write
    from actum_model_trainer.evaluation import evaluate

    if not recordings and maps_of(model) is None:
        raise NoMapsError(model)
    segments = answered_segments(model, recordings, progress)
    if recordings and not segments:
        raise NoSegmentError(
            "the given recordings contain no marked action: mark when actions start and end, either while recording "
            "(see 'actum segment --help') or afterwards with 'actum label'"
        )
    labelled = any(segment.label is not None for segment in segments)
    evaluation = evaluate(model, recordings, progress) if labelled else None
    planned = list(pictures(model, segments, evaluation))
    written = write(planned, folder, ending, progress)
    index = folder / PAGE
    index.write_text(page(model, segments, evaluation, planned, written), encoding="utf-8")
    note(index)
    return len(planned)
