"""What models tell of other people's movement: each set's actions as streams, before models of the other sets."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from benchmarks.originals import original
from benchmarks.recognition.datasets import Datasets
from benchmarks.recognition.scores import table

from actum.recording import Recording
from actum_model_trainer.continuous.detections import Detection, Found, Truth
from som_classifier.model import Model
from som_classifier.node import SomClassifier

from .bench import Bench, number
from .cad120 import cad120_recordings
from .streams import Stream, replayed

MINUTE_NS = 60_000_000_000
MOST_PER_MIN = 2
ALIKE = {
    ("waveHands", "two hand wave"), ("waveHands", "high arm wave"), ("clapHands", "hand clap"), ("throw", "high throw"),
    ("throw", "pickup & throw"), ("pickUp", "pickup & throw"), ("pickUp", "bend"), ("kick", "forward kick"),
    ("kick", "side kick"), ("bow", "bend"), ("bow", "pickUp"), ("push", "push right"), ("push", "forward punch"),
    ("shoot", "forward punch"), ("lift arms", "two hand wave"), ("duck", "sitDown"), ("wind up", "draw circle"),
}  # fmt: skip
"""Actions of two sets that are the same movement or part of it, whichever of them is taught."""


def strangers(bench: Bench) -> Iterator[str]:
    """Events told of movement that another set's people did, a minute."""
    data = bench.data
    models = {
        "UTKinect": bench.model_of(tuple(data.utkinect)),
        "MSRC-12 composed": bench.model_of(tuple(data.composed)),
        "the simulated scene": bench.model_of(data.simulated.training),
    }
    others = movement(bench)
    yield f"""All people of a set teach; the recordings of other sets are watched, unmarked, as they are. An event is
excused where the people really do the same at that moment, by a list of {len(ALIKE)} pairs of names. Required: at most
{MOST_PER_MIN} others a minute. CAD-120: part of its videos, a tenth to all of their frames, between these
interpolated."""
    rows = [
        _row(name, watched, model, others[watched])
        for (name, model), watched in product(models.items(), others)
        if watched not in name
    ]
    header = ("taught", "watched", "minutes", "events told", "excused", "others a minute", "told most often")
    yield table(header, rows)


def movement(bench: Bench) -> Mapping[str, Sequence[Recording]]:
    """Return the recordings of each set."""
    sets = Datasets(bench.data.imported)
    return {
        "MSR Action3D": sets.msr_recordings,
        "UTKinect": _recordings(bench.data.utkinect),
        "MSRC-12": _recordings(bench.data.composed)[::2],
        "CAD-120": cad120_recordings(original("cad120"), bench.data.imported),
    }


def _recordings(streams: Sequence[Stream]) -> list[Recording]:
    return [stream.recording for stream in streams]


def _row(taught: str, watched: str, model: Model, recordings: Sequence[Recording]) -> list[str]:
    found = sum((replayed(SomClassifier(model), recording) for recording in recordings), Found())
    minutes = sum((stretch.end_ns - stretch.start_ns) / MINUTE_NS for stretch in found.seen)
    told, excused = len(found.detections), sum(_is_alike(each, found.truths) for each in found.detections)
    labels = [each.label for each in found.detections]
    often = max(labels, key=labels.count, default="–")
    rate = number((told - excused) / minutes)
    return [taught, watched, f"{minutes:.1f}", str(told), str(excused), rate, f"{often} ({labels.count(often)})"]


def _is_alike(told: Detection, truths: Sequence[Truth]) -> bool:
    return any(
        told.label == truth.label or {(told.label, truth.label), (truth.label, told.label)} & ALIKE
        for truth in truths
        if truth.file == told.file and truth.start_ns < told.end_ns and told.start_ns < truth.end_ns
    )
