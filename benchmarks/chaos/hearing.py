"""What the listening client heard: the contents of all answers, and what was found besides the marks."""

from collections import defaultdict
from dataclasses import dataclass, field

from actum.messages import AUTO, Action, Event, Message, Segment


@dataclass
class Answer:
    """What one kind of message says of one segment, and when it said so first (s, monotonic)."""

    content: Action | Event
    arrived_s: float
    repeats: int = 0


@dataclass
class Heard:
    """Events and final actions by segment: each content once, with the number of its repeats."""

    events: dict[str, list[Answer]] = field(default_factory=lambda: defaultdict(list))
    actions: dict[str, list[Answer]] = field(default_factory=lambda: defaultdict(list))
    found: set[str] = field(default_factory=set)

    def hear(self, message: Message, now_s: float) -> list[str]:
        """Take a message; return a line for an answer that was not heard before."""
        match message:
            case Event():
                return _note(self.events[message.segment_id], message, now_s)
            case Action(final=True):
                return _note(self.actions[message.segment_id], message, now_s)
            case Segment(origin=origin) if origin == AUTO:
                self.found.add(message.segment_id)
        return []

    def contents(self, segment_id: str) -> int:
        """Return how many different contents a segment was answered with, by the kind that had more."""
        return max(len(self.events[segment_id]), len(self.actions[segment_id]))

    @property
    def repeats(self) -> int:
        """Answers that came again with the same content."""
        every = [*self.events.values(), *self.actions.values()]
        return sum(answer.repeats for answers in every for answer in answers)


def _note(answers: list[Answer], message: Action | Event, now_s: float) -> list[str]:
    content = message.model_copy(update={"seq": None})
    for answer in answers:
        if answer.content == content:
            answer.repeats += 1
            return []
    answers.append(Answer(content, now_s))
    return [f"{message.segment_id}: {told(content)}"]


def told(content: Action | Event) -> str:
    """Say in few words what an event or an action says."""
    kind = "event" if isinstance(content, Event) else "action"
    if not content.valid:
        return f"{kind} rejected ({content.reason})"
    thing = content.object if isinstance(content, Event) else None
    number = "" if thing is None else f" {thing.id}"
    return f"{kind} {content.action}{number}, {content.frames} frames, {content.missed} missed"
