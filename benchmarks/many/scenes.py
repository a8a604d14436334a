"""What several sensors see: crowds whose actions are marked, and what is answered to them where nothing is live."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from actum.messages import Action, Message, Segment, Skeleton
from actum.node import SECOND_NS, replay
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.group import MOST_PEOPLE, Group
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import labelled_stream
from som_classifier.model import Model
from som_classifier.node import SomClassifier

REPETITIONS = 8
"""How often each person does each action: more than the longest run shows."""
LATEST_MARK_S = 3.0
"""How long before the end of a scene (s) the last action that is marked has to be over, so that it is answered."""


class Answer(NamedTuple):
    """What is said of a segment: its action and its confidence, or why there is none, and from how many frames."""

    action: str | None
    confidence: float | None
    reason: str | None
    frames: int

    def __str__(self) -> str:
        return f"{self.reason or f'{self.action} {self.confidence}'} from {self.frames} frames"


def crowd(sensor: str, people: int, seed: int, seconds: float) -> list[Message]:
    """Return skeletons of so many people and the marks of their actions, by stamp.

    The people are groups of up to four who do different things, at each other's places.
    """
    groups = [_group(people - first, seed + first) for first in range(0, people, MOST_PEOPLE)]
    last_ns = round(seconds * SECOND_NS)
    skeletons: dict[int, list[Skeleton]] = {}
    marks: list[Segment] = []
    for number, group in enumerate(groups):
        for message in _until(group, last_ns):
            renumbered = _renumbered(message, sensor, number * MOST_PEOPLE)
            if isinstance(renumbered, Skeleton):
                skeletons.setdefault(renumbered.stamp_ns, []).append(renumbered)
            elif isinstance(renumbered, Segment):
                marks.append(renumbered)
    merged = [
        each[0].model_copy(update={"agents": [a for one in each for a in one.agents]}) for each in skeletons.values()
    ]
    over = {
        mark.segment_id for mark in marks if mark.kind == "end" and _stamp(mark) < last_ns - LATEST_MARK_S * SECOND_NS
    }
    return sorted([*merged, *(mark for mark in marks if mark.segment_id in over)], key=_stamp)


def answers(messages: Sequence[Message], model: Model) -> dict[str, Answer]:
    """Return what one classifier alone answers to each segment, marked or found."""
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    stream = list(
        replay(preprocessor, [(_stamp(message), message) for message in messages if isinstance(message, Skeleton)])
    )
    marked = sorted([*stream, *(m for m in messages if isinstance(m, Segment))], key=_stamp)
    said = replay(SomClassifier(model), [(_stamp(message), message) for message in marked])
    return {each.segment_id: answer(each) for each in said if isinstance(each, Action) and each.final}


def answer(action: Action) -> Answer:
    """Return what a final action says."""
    return Answer(action.action, action.confidence, action.reason, action.frames)


def _group(people: int, seed: int) -> Group:
    shown = min(people, MOST_PEOPLE)
    return Group([balanced_programme(REPETITIONS, seed + k) for k in range(shown)], actor_seed=seed, seed=seed)


def _until(group: Group, last_ns: int) -> Iterator[Message]:
    for message in labelled_stream(group):
        if _stamp(message) > last_ns:
            return
        yield message


def _renumbered(message: Message, sensor: str, first: int) -> Message:
    """Return a message of a group as one of this sensor's crowd."""
    match message:
        case Skeleton():
            agents = [each.model_copy(update={"agent": each.agent + first}) for each in message.agents]
            return message.model_copy(update={"sensor": sensor, "session_id": sensor, "agents": agents})
        case Segment(agent=int(agent)):
            name = f"{first}-{message.segment_id}"
            own = {"sensor": sensor, "segment_id": name, "agent": agent + first, "label": None}
            return message.model_copy(update=own)
        case _:
            return message


def _stamp(message: Message) -> int:
    return message.stamp_ns or 0
