"""Whether what is found is a true instance of its action as often as its familiarity says."""

from collections.abc import Iterator, Sequence

from benchmarks.recognition.scores import percent, table

from actum import keys
from actum.messages import Action, HeldBack, Message, Segment
from actum.node import replay
from actum_model_trainer.calibration_error import ConfidenceBin, calibration_error, confidence_bins
from actum_model_trainer.recorded_segments import classifier_input
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.segmentation import Segmentation

from .bench import Bench
from .streams import Fold, Stream, folds

COMMON_SHARE = 0.5
"""Of the shorter of a segment found and a true one: from this on they are of the same action."""


def familiarity(bench: Bench) -> Iterator[str]:
    """The calibration of familiarity where nobody marks."""
    sets = {"UTKinect": bench.data.utkinect, "MSRC-12, composed streams": bench.data.composed}
    yield f"""Every segment that the search finds, told or held back as unknown. It is a true instance where an action
of its name shares at least {COMMON_SHARE:.0%} of the shorter of both."""
    measured = [(name, _bins(bench, folds(of_set, of_set))) for name, of_set in sets.items()]
    yield table(("", "segments found", "true instances, %", "mean familiarity, %", "ECE"), (_row(*m) for m in measured))


def judged(model: Model, stream: Stream) -> list[tuple[float, bool]]:
    """Return the familiarity of each segment found in a stream, and whether it is a true instance of its action."""
    node = SomClassifier(model, segmentation=Segmentation("auto"))
    sensor = min(stream.recording.sensors(keys.SKELETON))
    unmarked = ((at, m) for at, m in classifier_input(stream.recording, sensor) if not isinstance(m, Segment))
    return [(found[3], _is_true(stream, *found[:3])) for message in replay(node, unmarked) for found in _found(message)]


def _found(message: Message) -> Iterator[tuple[str, int, int, float]]:
    is_told = isinstance(message, Action) and message.final and message.valid
    if is_told or (isinstance(message, HeldBack) and message.why == "unknown"):
        assert isinstance(message, Action | HeldBack)
        yield message.action or "", message.start_ns or 0, message.end_ns or 0, message.familiarity or 0.0


def _is_true(stream: Stream, label: str, start_ns: int, end_ns: int) -> bool:
    return any(
        truth.label == label
        and min(truth.end_ns, end_ns) - max(truth.start_ns, start_ns)
        >= COMMON_SHARE * min(truth.end_ns - truth.start_ns, end_ns - start_ns)
        for truth in stream.truths
    )


def _bins(bench: Bench, people: Sequence[Fold]) -> list[ConfidenceBin]:
    every = [pair for fold in people for stream in fold.test for pair in judged(bench.model_of(fold.training), stream)]
    return confidence_bins([said for said, _ in every], [is_true for _, is_true in every])


def _row(name: str, bins: Sequence[ConfidenceBin]) -> list[str]:
    count = sum(each.n for each in bins)
    if not count:
        return [name, "0", "–", "–", "–"]
    right, said = sum(each.correct for each in bins), sum(each.n * each.confidence for each in bins)
    return [name, str(count), percent(right / count), percent(said / count), f"{calibration_error(bins):.3f}"]
