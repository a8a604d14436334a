"""What one simulated person did in a scene that nobody marked, and what was told of it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from actum.messages import Action, Event, Message, Skeleton, Status
from actum.messages import Truth as TruthMessage
from actum.states import State
from actum_model_trainer.continuous.detections import Detection, Found, Interval, Stretch, Truth
from actum_model_trainer.continuous.matching import intersection_over_union, matched, overlap_ns
from actum_model_trainer.continuous.presence import Presence
from scene_simulator.simulator import AGENT, GATEWAY


@dataclass(frozen=True)
class Doing:
    """An everyday doing: which kind, and when (ns after the scene's first frame)."""

    kind: str
    start_ns: int
    end_ns: int


@dataclass
class Performance:
    """Everything that is heard while one person acts.

    Attributes:
        person: who acts; stands for the scene, as a file does for a recording.
        actions: how many actions there will be.
        doings: what the person does besides.
        events: the events, in the order in which they came, by what they say was done when.
        newest_ns: stamp of the newest skeleton.
    """

    person: str
    actions: int
    doings: Sequence[Doing] = ()
    events: dict[Detection, Event] = field(default_factory=dict)
    newest_ns: int = 0
    _starts: dict[str, TruthMessage] = field(default_factory=dict)
    _ends_ns: dict[str, int] = field(default_factory=dict)
    _first_ns: int | None = None
    _presence: Presence = field(init=False)
    _found: set[str] = field(default_factory=set)
    _told: set[str] = field(default_factory=set)
    _source_ended: bool = False

    def __post_init__(self) -> None:
        self._presence = Presence(self.person)

    def receive(self, message: Message) -> Detection | None:
        """Receive a message; return what is told by it, if it is a valid event."""
        match message:
            case Skeleton():
                self.newest_ns = message.stamp_ns
                if self._first_ns is None:
                    self._first_ns = message.stamp_ns
                if message.agents:
                    self._presence.see(AGENT, message.stamp_ns)
            case TruthMessage(kind="start"):
                self._starts[message.segment_id] = message
            case TruthMessage(kind="end"):
                self._ends_ns[message.segment_id] = message.stamp_ns
            case Status(service=service, state=state) if service == GATEWAY and len(self._ends_ns) == self.actions:
                self._source_ended = state == State.SOURCE_ENDED  # not before: it may be that of the scene before
            case Action(final=True):
                self._found.add(message.segment_id)
            case Event():
                return self._tell(message)
        return None

    @property
    def over(self) -> bool:
        """Whether the scene has ended, and every action that was found has become an event."""
        return self._source_ended and self._found <= self._told

    @property
    def done(self) -> dict[Truth, TruthMessage]:
        """The actions done so far, in order; one that goes on ends with the newest skeleton."""
        span = partial(Truth, self.person, AGENT)
        return {
            span(start.stamp_ns, self._ends_ns.get(name, self.newest_ns), start.action): start
            for name, start in self._starts.items()
        }

    @property
    def found(self) -> Found:
        """What was told, done and seen, as recordings without marks are scored."""
        return Found(tuple(self.events), tuple(self.done), self._presence.stretches)

    def answered(self) -> dict[Detection, Truth]:
        """Return which action each event answers, by its right name or else by another; some answer none."""
        right = matched(self.events, self.done, intersection_over_union)
        pairs = {match.detection: match.truth for match in right}
        told = {replace(each, label=""): each for each in self.events if each not in pairs}
        done = {replace(each, label=""): each for each in self.done if each not in pairs.values()}
        other = matched(told, done, intersection_over_union)
        return pairs | {told[match.detection]: done[match.truth] for match in other}

    def object_right(self, told: Detection, truth: Truth) -> bool:
        """Tell whether an event names the object that an action was done to."""
        named = self.events[told].object
        return named is not None and named.id == self.done[truth].object_id

    def doing_at(self, told: Interval) -> str | None:
        """Return the kind of the doing that has most of its time in common with what was told, None if none has any."""
        common_ns = [(overlap_ns(told, self._span(doing)), doing.kind) for doing in self.doings]
        longest_ns, kind = max(common_ns, default=(0, ""))
        return kind if longest_ns > 0 else None

    def _span(self, doing: Doing) -> Stretch:
        first_ns = self._first_ns or 0
        return Stretch(self.person, AGENT, first_ns + doing.start_ns, first_ns + doing.end_ns)

    def _tell(self, event: Event) -> Detection | None:
        self._told.add(event.segment_id)
        if not event.valid or event.action is None or event.end_ns is None:
            return None
        told = Detection(
            self.person, AGENT, event.start_ns, event.end_ns, self.newest_ns, event.action, event.confidence or 0.0
        )
        self.events[told] = event
        return told
