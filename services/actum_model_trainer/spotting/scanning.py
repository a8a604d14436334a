"""What heads answer to all windows that a live search would look at in streams of people they were not trained on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats, Indices
from actum.node import SECOND_NS
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.side_by_side import side_by_side
from actum_model_trainer.spotting.encoded_stream import EncodedStream
from actum_model_trainer.spotting.heads_training import Folds
from actum_model_trainer.spotting.training_windows import live_windows
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotting_model import CompletenessHeads, PyramidSpottingMetadata

CHUNK = 64
"""Windows whose vectors are held at once: they stay in the processor's cache until they are multiplied."""

LANES = 4
"""Heads are padded to multiples of this many: BLAS multiplies 13 of them in a quarter more time than 16."""


@dataclass(frozen=True, eq=False)
class ScannedStream:
    """A stream with its live windows and what heads that were trained without it answer.

    Attributes:
        stream: with its labelled segments.
        windows: (n, 2), first and last frame.
        completeness: (n, actions), or with the common head's in the last column (n, actions + 1).
    """

    stream: LabelledStream
    windows: Indices
    completeness: Floats


def scanned(
    model: PyramidModel,
    streams: Sequence[LabelledStream],
    heads: Sequence[CompletenessHeads],
    folds: Folds,
    metadata: PyramidSpottingMetadata,
    progress: Progress,
) -> list[ScannedStream]:
    """Answer all live windows of the streams, each by the heads that were trained without its fold, of that number."""
    durations_ns = np.rint(np.array(metadata.window_durations_s) * SECOND_NS).astype(np.int64)

    def answered(stream: LabelledStream) -> ScannedStream:
        windows = live_windows(stream.stamps_ns, durations_ns, round(metadata.interval_s * SECOND_NS))
        return ScannedStream(stream, windows, _answers(model, stream, windows, heads, folds))

    return side_by_side(answered, streams, "searching streams", progress)


def _answers(
    model: PyramidModel, stream: LabelledStream, windows: Indices, heads: Sequence[CompletenessHeads], folds: Folds
) -> NDArray[np.float32]:
    """Return the answers (n, actions) to windows (n, 2) of a stream."""
    encoded, of_fold = EncodedStream(model, stream, windows), folds.of(stream, windows)
    actions = len(heads[0].offsets)
    answers = np.zeros((len(windows), actions), np.float32)
    room = np.empty((CHUNK, len(heads[0].axes)), np.float32)
    for fold in np.unique(of_fold).tolist():
        axes, offsets = np.pad(heads[fold].axes, ((0, 0), (0, -actions % LANES))), heads[fold].offsets
        for first, after in runs_of(np.flatnonzero(of_fold == fold)):
            for start in range(first, after, CHUNK):
                chunk = slice(start, min(start + CHUNK, after))
                vectors = room[: chunk.stop - start]
                encoded.pool(chunk.start, chunk.stop, vectors)
                answers[chunk] = (vectors @ axes)[:, :actions] + offsets
    return answers


def runs_of(numbers: Indices) -> list[tuple[int, int]]:
    """Return the runs of rising numbers (n,) without a gap: the first of each, and the one after its last."""
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    return [(int(run[0]), int(run[-1]) + 1) for run in runs if len(run)]
