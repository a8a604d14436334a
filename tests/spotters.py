"""Spotters that do as they are told, and models that have them, for tests of what becomes of found segments."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

from actum.node import SECOND_NS, Counters
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotted import NOTHING, Ongoing, Spotted, SpottedSegment, Spotter, SpottingOptions

LAG_NS = SECOND_NS // 5
LONGEST_GAP_NS = 3 * SECOND_NS // 10


@dataclass(frozen=True, eq=False)
class SpottingModel(PyramidModel):
    """A model whose search is given."""

    search: Callable[[SpottingOptions], Spotter | None] = lambda _: None
    seen_background_s: float | None = None

    @property
    def background_s(self) -> float | None:
        return self.seen_background_s

    def spotters(self, asked: Sequence[SpottingOptions]) -> list[Spotter]:
        return [spotter for options in asked if (spotter := self.search(options)) is not None]


def spotting(model: Model, search: Callable[[SpottingOptions], Spotter | None], background_s: float = 60.0) -> Model:
    """Return the model with a search; it calls nothing unknown, so that whatever is found is answered."""
    parts = {field.name: getattr(model, field.name) for field in fields(PyramidModel)}
    parts["body"] = replace(parts["body"], least_m=0.0)
    parts["verifier"] = replace(parts["verifier"], least_likeness=-1e9, least_found_likeness=-1e9)
    return SpottingModel(**parts, search=search, seen_background_s=background_s)


class Beats(Spotter):
    """Finds an action from 0.2 to 0.8 s of every second of the sensor's clock, 0.2 s after its end.

    One with a gap in its frames, or begun before the spotter was, is not found.
    """

    def __init__(self, label: str = "lift", period_ns: int = SECOND_NS) -> None:
        self._label = label
        self._period_ns = period_ns
        self._stamps_ns: list[int] = []

    def step(self, frame: Frame) -> Spotted:
        if self._stamps_ns and frame.stamp_ns - self._stamps_ns[-1] > LONGEST_GAP_NS:
            self._stamps_ns = []
        self._stamps_ns = [ns for ns in self._stamps_ns if frame.stamp_ns - ns < 2 * self._period_ns] + [frame.stamp_ns]
        beat_ns = frame.stamp_ns // self._period_ns * self._period_ns
        own_ns = [ns for ns in self._stamps_ns if 0.2 <= (ns - beat_ns) / self._period_ns <= 0.8]
        if len(own_ns) < 3 or self._stamps_ns[0] > beat_ns + self._period_ns // 5:
            return NOTHING
        if frame.stamp_ns == own_ns[-1]:
            done = (frame.stamp_ns - beat_ns) / self._period_ns
            return Spotted(ongoing=Ongoing(own_ns[0], self._label, 0.5 + 0.5 * done, done))
        before_ns = self._stamps_ns[-2]
        due_ns = own_ns[-1] + LAG_NS // 2
        if before_ns < due_ns <= frame.stamp_ns:
            return Spotted((SpottedSegment(own_ns[0], own_ns[-1], self._label),))
        return NOTHING


def beating(model: Model, **more: object) -> Model:
    """Return the model with a search that finds an action every second."""
    return spotting(model, lambda _: Beats(**more))  # type: ignore[arg-type]


class Scripted(Spotter):
    """Finds given segments, each with the first frame that has passed its end by a lag; before, it goes on."""

    def __init__(self, *segments: SpottedSegment, lag_ns: int = LAG_NS) -> None:
        self._segments = segments
        self._lag_ns = lag_ns
        self._before_ns = -1

    def step(self, frame: Frame) -> Spotted:
        before_ns, self._before_ns = self._before_ns, frame.stamp_ns
        due = tuple(s for s in self._segments if before_ns < s.end_ns + self._lag_ns <= frame.stamp_ns)
        going = [s for s in self._segments if s.start_ns <= frame.stamp_ns <= s.end_ns]
        return Spotted(due, next((_ongoing(s, frame.stamp_ns) for s in going), None))


def _ongoing(segment: SpottedSegment, now_ns: int) -> Ongoing:
    done = (now_ns - segment.start_ns) / (segment.end_ns - segment.start_ns)
    return Ongoing(segment.start_ns, segment.label, 0.9, done)


def finding(model: Model, *segments: SpottedSegment, **more: float) -> Model:
    """Return the model with a search that finds given segments in every stream."""
    return spotting(model, lambda _: Scripted(*segments), **more)


class Box:
    """A place where a model may be put."""

    def __init__(self) -> None:
        self.model: Model | None = None

    def poll(self, counters: Counters) -> Model | None:
        model, self.model = self.model, None
        return model
