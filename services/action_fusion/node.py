"""The fusion's pure step: waits until the input streams have reached a segment's end, and puts one event for it.

A stream that stands still, as when a link is cut, is waited for longer than one that goes on.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from action_fusion.fusion import fuse, rejected
from action_fusion.intake.buffers import LATEST_ACTION_NS, Buffer, KnownObjects, ObjectsBuffer, PostureBuffers, S
from action_fusion.intake.losses import Before
from action_fusion.intake.stream_samples import ObjectsSample, objects_sample, posture_sample
from action_fusion.intent.intents import Intents
from action_fusion.settings import Settings
from actum import keys
from actum.commands import Command
from actum.flow import Flow
from actum.limits import MAX_SKEW_NS
from actum.messages import Action, Event, Message, Objects, Posture
from actum.node import SECOND_NS, Counters, Tick
from actum.parameters import LiveParameters
from actum.stamps import Order

WAIT_NS = MAX_SKEW_NS + SECOND_NS // 5
"""How long an action waits: the skew, and two ticks, since waiting is counted from the first tick after the action."""

REMEMBERED = 10_000
"""Answered segments remembered to recognise duplicates: more than a day has, in little memory."""

MOST_PENDING = 64
"""Most actions that wait: as many as may be marked at once, twice."""

ONGOING_NS = 2 * SECOND_NS
"""How long after a partial action its segment counts as going on (ns): the next comes with the next frame."""

MOST_SIGHTINGS = 4_000
"""Most messages of objects kept: the time that they count, at 50 a second."""

LIVE = (
    "measure", "reach_m", "grasp_m", "moved_m", "pointing_limit_deg", "uncertainty_m", "pointing_uncertainty_deg",
)  # fmt: skip
"""The settings that may be changed while it runs."""


@dataclass
class Pending:
    """An action that waits for the input streams; `since_ns` is the time of the first tick after its arrival."""

    action: Action
    end_ns: int
    since_ns: int | None = None

    def is_before(self, restart_ns: int) -> bool:
        """Tell whether the action's segment lies before the restart of a stream at stamp `restart_ns`."""
        return self.action.start_ns < restart_ns or self.end_ns > restart_ns + MAX_SKEW_NS


class ActionFusion:
    """Joins each recognised action with the object it is applied to: exactly one event per segment.

    Only samples with stamps up to the segment's end count, so that skew between the streams changes nothing.
    """

    name = "action_fusion"
    inputs: tuple[keys.Topic, ...] = (keys.POSTURE, keys.OBJECTS, keys.ACTION)
    answers = keys.EVENT
    on_demand = keys.INTENT
    may_wait = (keys.POSTURE, keys.OBJECTS)

    def __init__(self, settings: Settings) -> None:
        self.counters = Counters()
        self._use_settings(settings)
        self._parameters = LiveParameters(settings, LIVE, self._use_settings)
        self._postures = PostureBuffers(self.counters)
        self._objects = ObjectsBuffer()
        self._known = KnownObjects(self.counters)
        self._intents = Intents()
        self.is_demanded = True
        self._pending: list[Pending] = []
        self._answered: dict[tuple[str, int, int | None, str | None], None] = {}
        self._before = Before()
        self._flows = {Posture: Flow(), Objects: Flow()}
        self._ongoing: dict[str, int] = {}
        self._now_ns = 0

    def remember(self, answers: Sequence[Message]) -> None:
        """Take the events that were put before this process was there: it puts no others for their segments."""
        self._before = Before([answer for answer in answers if isinstance(answer, Event)], resumed=True)
        for flow in self._flows.values():
            flow.expect()

    @property
    def is_busy(self) -> bool:
        """Whether an action waits for its samples, or is going on."""
        return bool(self._pending) or any(self._now_ns - seen_ns < ONGOING_NS for seen_ns in self._ongoing.values())

    @property
    def has_time(self) -> bool:
        """Whether no action waits for samples, and nobody wants to know at once what people are about to touch."""
        return not (self._pending or self.is_demanded)

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """Reading and changing settings while it runs."""
        return self._parameters.commands

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Process one posture, objects message, action or tick; return what it completes or lets expect."""
        match message:
            case Posture():
                return self._posture(message)
            case Objects():
                return self._take(self._objects, objects_sample(self._known.known(message), self.counters), "objects")
            case Action(final=True):
                self._ongoing.pop(message.segment_id, None)
                self._intents.action(message)
                return self._action(message)
            case Action():
                self._ongoing[message.segment_id] = self._now_ns
                self._intents.action(message)
            case Tick():
                return self._tick(message)
        return []

    def _use_settings(self, settings: Settings) -> None:
        self._settings = settings

    def _posture(self, posture: Posture) -> list[Message]:
        """Take a posture; return the events that it completes, then what the person is about to touch, if wanted."""
        sample, buffer = posture_sample(posture, self.counters), self._postures.of(posture.agent)
        events = self._take(buffer, sample, f"posture of agent {posture.agent}")
        if not posture.agent or sample.body is None or buffer.newest is not sample:
            return [*events]
        if not self.is_demanded:
            self._intents.take(sample, posture.agent)
            return [*events]
        intent = self._intents.posture(sample, posture.agent, posture.sensor)
        return [*events] if intent is None else [*events, intent]

    def _take(self, buffer: Buffer[S], sample: S, what: str) -> list[Event]:
        """Add a sample to its stream; return the events of actions that waited for it or lie before a restart."""
        order = buffer.judge(sample)
        if order is Order.STALE:
            self.counters.reject("stale_stamp", f"{what} at {sample.stamp_ns} after {buffer.newest_ns}")
            return []
        events = []
        if order is Order.RESTART:
            events = [self._answer(pending) for pending in list(self._pending) if pending.is_before(sample.stamp_ns)]
            buffer.clear()
            streams: list[Buffer[Any]] = [self._objects, *self._postures.values()]
            for stream in streams:
                if stream.newest_ns > sample.stamp_ns + MAX_SKEW_NS:
                    stream.clear()
            self._answered.clear()
            self._intents.clear()
        if buffer.is_too_late(sample.stamp_ns):
            self.counters.reject("late", f"{what} at {sample.stamp_ns}, after its segment was answered")
        buffer.append(sample)
        if isinstance(sample, ObjectsSample):
            self._intents.objects(sample)
        self._flows[Objects if buffer is self._objects else Posture].note()
        self._make_room()
        return events + self._complete()

    def _make_room(self) -> None:
        """Forget the oldest sample where there are too many."""
        if len(self._objects) > MOST_SIGHTINGS:
            self._objects.let_go()
            self.counters.reject("too_many_frames", f"more than {MOST_SIGHTINGS} messages of objects in a minute")
        self._postures.make_room()

    def _action(self, action: Action) -> list[Event]:
        if self._before.answered(action):
            self.counters.counts["actions_told_again"] += 1
            return []
        segment = (action.segment_id, action.start_ns, action.end_ns, action.reason)
        if segment in self._answered:
            self.counters.reject(
                "duplicate_segment", f"{action.segment_id!r} from {action.start_ns} to {action.end_ns}"
            )
            return []
        self._answered[segment] = None
        if len(self._answered) > REMEMBERED:
            del self._answered[next(iter(self._answered))]
        if not action.valid:
            return [rejected(action, action.reason or "rejected without a reason")]
        if action.action is None or action.end_ns is None or action.end_ns < action.start_ns:
            self.counters.reject("bad_action", f"final action of {action.segment_id!r} without a label or an end")
            return [rejected(action, "final action without a label or an end")]
        bare = action.model_copy(update={"maps": None, "trace": None})
        self._pending.append(Pending(bare, action.end_ns))
        events = self._complete()
        if len(self._pending) > MOST_PENDING:
            self.counters.reject("too_many_actions", f"more than {MOST_PENDING} wait: the oldest is answered now")
            events.append(self._answer(self._pending[0]))
        return events

    def _tick(self, tick: Tick) -> list[Event]:
        """Return the events of actions that have waited long enough, from the samples received so far."""
        self._now_ns = tick.monotonic_ns
        self._ongoing = {name: ns for name, ns in self._ongoing.items() if self._now_ns - ns < ONGOING_NS}
        for flow in self._flows.values():
            flow.tick(tick.monotonic_ns)
        events = []
        for pending in list(self._pending):
            if pending.since_ns is None:
                pending.since_ns = tick.monotonic_ns
            elif tick.monotonic_ns - pending.since_ns >= WAIT_NS and self._may_come_no_more(pending, pending.since_ns):
                events.append(self._answer(pending))
        return events

    def _may_come_no_more(self, pending: Pending, since_ns: int) -> bool:
        """Tell whether an action that has waited for its samples since a tick is to be answered without them."""
        newest_ns = {Posture: self._postures.newest_ns, Objects: self._objects.newest_ns}
        return all(
            newest_ns[kind] >= pending.end_ns or flow.ended(since_ns, WAIT_NS) for kind, flow in self._flows.items()
        )

    def _complete(self) -> list[Event]:
        """Return the events of the actions that have all their samples, up to the stamp of the segment's end."""
        return [self._answer(pending) for pending in list(self._pending) if self._is_complete(pending)]

    def _is_complete(self, pending: Pending) -> bool:
        """Tell whether all streams have reached the segment's end; one far beyond it still lies before a restart."""
        postures = self._postures.get(pending.action.agent)
        reached = (-1 if postures is None else postures.newest_ns, self._objects.newest_ns)
        if not all(pending.end_ns <= newest_ns <= pending.end_ns + LATEST_ACTION_NS for newest_ns in reached):
            return False
        others = self._postures.others(pending.action.agent, pending.action.start_ns, pending.end_ns)
        return all(buffer is not None and buffer.newest_ns >= last_ns for buffer, last_ns in others)

    def _answer(self, pending: Pending) -> Event:
        self._pending.remove(pending)
        action, start_ns, end_ns = pending.action, pending.action.start_ns, pending.end_ns
        own = self._postures.of(action.agent)
        others = self._postures.others(action.agent, start_ns, end_ns)
        people = [own, *(buffer for buffer, _ in others if buffer is not None)]
        for buffer in (own, self._objects):
            buffer.mark_answered(start_ns, end_ns)
        of_people = [buffer.stamps_since(start_ns) for buffer in self._postures.values()]
        postures_ns = sorted(ns for stamps_ns in of_people if len(stamps_ns) for ns in stamps_ns[[0, -1]].tolist())
        objects_ns = self._objects.stamps_since(start_ns)
        if (reason := self._before.why_incomplete(postures_ns, objects_ns, start_ns, end_ns)) is not None:
            self.counters.reject("incomplete_segment", f"{action.segment_id}: {reason}")
            return rejected(action, reason)
        event = fuse(
            action,
            own.of_segment(start_ns, end_ns),
            [buffer.hands_of_segment(start_ns, end_ns) for buffer in people],
            self._objects.sightings_of_segment(start_ns, end_ns),
            self._objects.of_segment(start_ns, end_ns),
            self._settings,
        )
        self._intents.event(event)
        return event
