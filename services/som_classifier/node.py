"""The classifier's pure step: postures, and marks where there are any, become partial and final actions."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Literal, Protocol

from actum import keys
from actum.commands import Command, NoFields, Refusal
from actum.messages import AUTO, Action, Continuation, Message, Posture, Segment, WhyHeldBack
from actum.node import Counters, Tick
from actum.parameters import LiveParameters
from actum.states import State
from som_classifier.answers import final_action, held_back, ongoing_action, own_mark, partial_action, tensor
from som_classifier.continuation import LOOKED_BACK_NS
from som_classifier.frames import Frame
from som_classifier.model import Model, Recognition
from som_classifier.model_loading import WatchedModel
from som_classifier.model_maps import MapDescription, NoMapsError, map_description
from som_classifier.placed_continuation import continuation_of, moves
from som_classifier.segmentation import DEFAULT, Segmentation
from som_classifier.segmenter import Segmenter
from som_classifier.segments import ClosedSegment, OpenSegment
from som_classifier.settings import Settings
from som_classifier.spotting.search import Search
from som_classifier.spotting.spotted import Ongoing, SpottedSegment
from som_classifier.stream import Stream

Fate = WhyHeldBack | Literal["told", "marked"]
"""What becomes of a segment that was found: published, answered by its mark, or held back."""
POLL_TICKS = 5
"""Ticks between two checks of the model file, half a second: a new model seems to be used at once."""

MARKS_OFF = "marks are not used: the classifier's setting segments is auto"
"""Why marks are rejected where only found segments are wanted."""
LIVE = (
    "segments", "false_alarms_per_min", "shortest_pause_s", "cooldown_s", "enabled_actions", "disabled_actions",
    "publish_maps",
)  # fmt: skip
"""The settings that may be changed while it runs."""


class ModelSource(Protocol):
    """Where a new model may come from while the node runs."""

    def poll(self, counters: Counters) -> Model | None:
        """Return the model if it is new since the last call, else None."""
        ...


class SomClassifier:
    """Estimates the action while a segment is open, and answers it once when it closes.

    It answers the segments that are marked, and marks and answers those that it finds by itself. With a model that has
    a continuation, it also puts how the posture of a person who moves goes on.
    """

    name = "som_classifier"
    inputs = (keys.POSTURE, keys.SEGMENT)
    answers = keys.ACTION
    on_demand = keys.CONTINUATION

    def __init__(
        self,
        model: Model | None = None,
        source: ModelSource | None = None,
        publish_maps: bool = False,
        segmentation: Segmentation = DEFAULT,
    ) -> None:
        self.counters = Counters(state=State.RUNNING if model else State.NO_MODEL)
        self._segmenter = Segmenter(self.counters)
        self._segmentation = segmentation
        self._model: Model | None = None
        if model is not None:
            self._use(model)
        self._source = source
        self._publish_maps = publish_maps
        self.is_demanded = True
        self._parameters: tuple[Command[Any, Any], ...] = ()
        self._ticks = 0
        self._sensor = "unknown"
        self._session = ""

    @classmethod
    def configured(cls, settings: Settings) -> "SomClassifier":
        """Build the node as the settings say; the model file need not exist yet."""
        source = WatchedModel(settings.model) if settings.model else None
        node = cls(None, source, settings.publish_maps, settings.segmentation)
        node._parameters = LiveParameters(settings, LIVE, node._use_settings).commands
        if settings.model is None:
            node.counters.state = State.NO_MODEL.because("--model (ACTUM_MODEL) names none")
        node._reload()
        return node

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """Reading and changing settings while it runs, and what the model's maps stand for."""
        return (*self._parameters, Command("maps", NoFields, MapDescription, self._describe_maps))

    def remember(self, answers: Sequence[Message]) -> None:
        """Take the answers given before this process was there: it gives no others to their segments."""
        self._segmenter.remember([answer for answer in answers if isinstance(answer, Action)])

    @property
    def is_busy(self) -> bool:
        """Whether a marked segment is open, or the search sees an action going on."""
        return self._segmenter.is_busy

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Receive a posture, a mark or a tick; return the marks, partial and final actions that follow from it."""
        if isinstance(message, Message):
            self._sensor = message.sensor
        match message:
            case Posture():
                return list(self._posture(message))
            case Segment():
                return self._mark(message)
            case Tick():
                self._ticks += 1
                if self._ticks % POLL_TICKS == 0:
                    self._reload()
                return [self._final(closed) for closed in self._segmenter.tick(message)]
        return []

    def _mark(self, mark: Segment) -> list[Message]:
        """Answer a mark, but not one that a classifier put: it has put the answer as well."""
        if mark.origin == AUTO:
            return []
        if self._segmentation.segments == "auto":
            self.counters.counts["marks_ignored"] += 1
            return [self._final(closed) for closed in self._segmenter.decline(mark, MARKS_OFF)]
        return [self._final(closed) for closed in self._segmenter.mark(mark)]

    def _reload(self) -> None:
        model = self._source.poll(self.counters) if self._source else None
        if model is not None:
            self._use(model)

    def _use_settings(self, settings: Settings) -> None:
        self._publish_maps, self._segmentation = settings.publish_maps, settings.segmentation
        if self._model is not None:
            self.counters.state = self._segmentation.state(self._model)
            self._segmenter.streams.adjust(self._segmentation.plan(self._model))

    def _describe_maps(self, _request: NoFields) -> MapDescription:
        """Tell what the units of the model's maps stand for: a body for each posture, an action for each place."""
        try:
            return map_description(self._model)
        except NoMapsError as error:
            raise Refusal(str(error)) from None

    def _use(self, model: Model) -> None:
        self._model, self.counters.state = model, self._segmentation.state(model)
        self.counters.details["model"] = model.id
        self._segmenter.streams.use(lambda: model.encoder().encode, self._segmentation.plan(model))

    def _posture(self, posture: Posture) -> Iterator[Message]:
        frame, closed = self._segmenter.posture(posture)
        stream = None if frame is None else self._segmenter.streams.of(posture.agent)
        if stream is not None:
            for segment in self._segmenter.open_at(posture.agent, posture.stamp_ns):
                yield from self._partial(segment, stream, posture)
        self._session = self._session or posture.session_id
        for answer in closed:  # of the session before, where this posture begins another
            yield self._final(answer)
        self._session = posture.session_id
        if frame is not None and stream is not None and posture.agent:  # nobody's actions cannot be marked
            spotted = stream.search.step(frame)
            for found in spotted.segments:
                yield from self._found(found, stream, posture.agent)
            if spotted.ongoing is not None:
                yield from self._ongoing(spotted.ongoing, stream, posture)
            yield from self._continued(stream, frame, posture)

    def _continued(self, stream: Stream, newest: Frame, posture: Posture) -> Iterator[Continuation]:
        """Say how the posture goes on, if somebody wants to know: that depends on postures alone, not on marks."""
        going_on = None if self._model is None else self._model.continuation
        if not self.is_demanded or not newest.valid or going_on is None:
            return
        frames = [frame for frame in stream.between(newest.stamp_ns - LOOKED_BACK_NS, newest.stamp_ns) if frame.valid]
        if not moves(frames):
            return
        if (continued := continuation_of(going_on.ahead(frames), newest, posture)) is not None:
            yield continued
        else:
            self.counters.reject("bad_posture", f"no usable place of agent {posture.agent} at {posture.stamp_ns}")

    def _partial(self, segment: OpenSegment, stream: Stream, posture: Posture) -> Iterator[Action]:
        seen = stream.stretch(segment.start_ns or 0, posture.stamp_ns)
        recognition = self._recognise(seen.usable, complete=False)
        if recognition is not None:
            yield partial_action(segment, recognition, seen, posture)

    def _found(self, found: SpottedSegment, stream: Stream, agent: int) -> Iterator[Message]:
        """Mark and answer a segment that was found, unless it is not to be published; count what becomes of it."""
        search = stream.search
        closed = stream.cut(OpenSegment(self._next_id(search), found.start_ns, agent, end_ns=found.end_ns))
        answer = None if closed.reason else self._recognise(closed.usable, complete=True)
        recognition = answer and answer.where_found(found.precision)
        fate = self._fate(closed, recognition, search)
        self.counters.counts.update(["found", fate])
        if fate == "told":
            search.count_told()
            yield own_mark("start", closed, self._sensor)
            yield own_mark("end", closed, self._sensor)
            yield self._answer(closed, recognition, None)
        elif fate != "marked":
            action = found.label if recognition is None else recognition.label
            yield held_back(closed, action, recognition, fate, self._sensor, self._session)

    def _fate(self, closed: ClosedSegment, recognition: Recognition | None, search: Search) -> Fate:
        """Decide what becomes of a segment that was found.

        The search knows no more of other doings than the background it was trained on; what it never saw is unlike
        what was taught. The user's options hold for the action that would be published.
        """
        if recognition is None:
            return "unanswerable"
        if self._segmenter.is_marked(closed.agent, closed.start_ns, closed.end_ns):
            return "marked"
        if recognition.unknown or recognition.doubtful:
            return "unknown"
        return search.admission.admit(recognition.label, closed.start_ns, closed.end_ns) or "told"

    def _ongoing(self, ongoing: Ongoing, stream: Stream, posture: Posture) -> Iterator[Action]:
        """Say what seems to be going on, unless it is marked or would not be published."""
        search, bounds = stream.search, (ongoing.start_ns, posture.stamp_ns)
        hindrance = search.admission.hindrance(ongoing.label, ongoing.start_ns)
        if hindrance is None and not self._segmenter.is_marked(posture.agent, *bounds):
            yield ongoing_action(self._next_id(search), ongoing, stream.stretch(*bounds), posture)

    def _next_id(self, search: Search) -> str:
        """Return the id that the next segment found gets: not one that was given before this process was there."""
        while self._segmenter.is_answered(search.next_id):
            search.count_told()
        return search.next_id

    def _recognise(self, usable: list[Frame], complete: bool) -> Recognition | None:
        if self._model is None or len(usable) < self._model.min_frames:
            return None
        return self._model.recognise(usable, complete)

    def _final(self, closed: ClosedSegment) -> Action:
        recognition = None if closed.reason else self._recognise(closed.usable, closed.is_seen_to_its_end)
        reason = closed.reason
        if reason is None and self._model is None:
            reason = "no model"
        elif reason is None and self._model is not None and recognition is None:
            reason = f"too few frames: {len(closed.usable)}, at least {self._model.min_frames} are needed"
        if reason:
            self.counters.reject("rejected_segment", f"{closed.segment_id}: {reason}")
        return self._answer(closed, recognition, reason)

    def _answer(self, closed: ClosedSegment, recognition: Recognition | None, reason: str | None) -> Action:
        explained: dict[str, Any] = {}
        if recognition is not None and self._model is not None and self._publish_maps:
            maps = {name: tensor(activity) for name, activity in self._model.maps(closed.usable).items()}
            explained = {"maps": maps, "trace": tensor(self._model.trace(closed.usable))}
        return final_action(closed, recognition, reason, self._sensor, session_id=self._session, **explained)
