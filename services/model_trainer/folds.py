"""Which parts of a set are left out in turn to test on: one person after another, or else a share of the examples."""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from actum.messages import NONE
from actum_model_trainer.continuous.detections import Detection, Found, Truth
from actum_model_trainer.samples import LabelledStream, Samples, SegmentSample

FOLDS = 3
"""Shares of the examples that are left out in turn where people cannot be: each takes a training."""
Span = tuple[int, int]
"""From a stamp (ns) up to but without another."""
EVER: Span = (0, 2**62)
"""All stamps there are."""


@dataclass(frozen=True)
class Fold:
    """What is left out of one training, to test on: spans of stamps, by file."""

    name: str
    spans: Mapping[str, Sequence[Span]]

    def holds(self, file: str, start_ns: int, end_ns: int) -> bool:
        """Return whether the middle of a span of time is left out."""
        middle_ns = (start_ns + end_ns) // 2
        return any(first <= middle_ns < last for first, last in self.spans.get(file, ()))

    def holds_sample(self, sample: SegmentSample) -> bool:
        """Return whether an example is left out."""
        return self.holds(sample.file, int(sample.stamps_ns[0]), int(sample.stamps_ns[-1]))

    def without(self, stream: LabelledStream) -> LabelledStream:
        """Return a stream without what is left out."""
        kept = np.ones(len(stream.stamps_ns), dtype=bool)
        for first, last in self.spans.get(stream.file, ()):
            kept &= (stream.stamps_ns < first) | (stream.stamps_ns >= last)
        segments = tuple(each for each in stream.segments if not self.holds(stream.file, each[0], each[1]))
        return replace(
            stream,
            stamps_ns=stream.stamps_ns[kept],
            motion=stream.motion[kept],
            postures=stream.postures[kept],
            velocities=stream.velocities[kept],
            segments=segments,
        )

    def within(self, found: Found) -> Found:
        """Return of what was found, done and seen what lies in the part that is left out."""
        seen = [
            replace(each, start_ns=max(each.start_ns, first), end_ns=min(each.end_ns, last - 1))
            for each in found.seen
            for first, last in self.spans.get(each.file, ())
        ]
        inside = tuple(each for each in seen if each.start_ns < each.end_ns)
        return Found(self._of(found.detections), self._of(found.truths), inside)

    def _of(self, intervals: Sequence[Detection] | Sequence[Truth]) -> tuple:  # type: ignore[type-arg]
        return tuple(each for each in intervals if self.holds(each.file, each.start_ns, each.end_ns))


def folds_of(samples: Samples) -> tuple[str, list[Fold]]:
    """Choose the folds; return by what they are: `people` where each action is shown by several, else `examples`."""
    shown_by: defaultdict[str, set[str]] = defaultdict(set)
    for sample in samples.usable:
        shown_by[sample.label].add(sample.person)
    if shown_by and all(len(people) > 1 for people in shown_by.values()):
        return "people", _by_people(samples)
    return "examples", _by_examples(samples)


def _by_people(samples: Samples) -> list[Fold]:
    files: defaultdict[str, set[str]] = defaultdict(set)
    for stream in samples.streams:
        files[stream.person].add(stream.file)
    tested = sorted({sample.person for sample in samples.usable})
    return [Fold(f"without {person or 'unnamed'}", dict.fromkeys(files[person], (EVER,))) for person in tested]


def _by_examples(samples: Samples) -> list[Fold]:
    """Deal the examples of each action to the folds in turn, with the time about each up to halfway to the next.

    Counterexamples are dealt as if none were an action.
    """
    dealt: Counter[str] = Counter()
    spans: list[defaultdict[str, list[Span]]] = [defaultdict(list) for _ in range(FOLDS)]
    of_file: defaultdict[str, list[SegmentSample]] = defaultdict(list)
    for sample in samples.usable:
        of_file[sample.file].append(sample)
    for file in sorted({stream.file for stream in samples.streams}):
        own = sorted(of_file[file], key=lambda sample: int(sample.stamps_ns[0]))
        for sample, span in zip(own, _territories(own), strict=True):
            spans[dealt[sample.label] % FOLDS][file].append(span)
            dealt[sample.label] += 1
        if all(stream.is_counterexample for stream in samples.streams if stream.file == file):
            spans[dealt[NONE] % FOLDS][file].append(EVER)
            dealt[NONE] += 1
        elif not own:
            for number, span in enumerate(_shares(file, samples.streams)):
                spans[number][file].append(span)
    return [Fold(f"fold {number} of {FOLDS}", dict(each)) for number, each in enumerate(spans, start=1) if each]


def _territories(own: Sequence[SegmentSample]) -> list[Span]:
    """Part all time among the examples of a file: each has that from halfway after the one before it."""
    ends = [int(sample.stamps_ns[-1]) for sample in own]
    starts = [int(sample.stamps_ns[0]) for sample in own]
    borders = [EVER[0], *((end + start) // 2 for end, start in zip(ends, starts[1:], strict=False)), EVER[1]]
    return list(pairwise(borders))[: len(own)]


def _shares(file: str, streams: Sequence[LabelledStream]) -> list[Span]:
    """Part the time of a file without examples evenly."""
    stamps_ns = np.concatenate([stream.stamps_ns for stream in streams if stream.file == file])
    edges = np.linspace(int(stamps_ns.min()), int(stamps_ns.max()) + 1, FOLDS + 1).astype(np.int64).tolist()
    return list(pairwise(edges))
