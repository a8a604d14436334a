"""What becomes of a recording where its marked segments are deleted, moved or mirrored: one meaning for every program.

The frames follow the segments by one rule: a person's frame is stored mirrored where, and only where, a mirrored
segment of that person holds it. A deleted example takes the frames of whoever acts in it away, or they would be learnt
as background; frames that another example of that person holds stay.
"""

import json
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

from pydantic import TypeAdapter, ValidationError

from actum import codec, keys
from actum.mcap_file import StoredMessage
from actum.messages import Action, Agent, Event, Message, Posture, Segment, Skeleton, Truth
from actum.recording import Recording
from actum.rewriting import Change
from actum.skeletons import INDEX
from som_classifier.handedness import OPPOSITE

DOUBTS, MIRRORED = "doubts", "mirrored"
"""Fields of a recording's metadata: doubts (texts by segment id) and mirrored segment ids, as JSON."""
TEXTS, IDS = TypeAdapter(dict[str, list[str]]), TypeAdapter(list[str])
"""The forms of these."""
OF_THE_TAKE = ""
"""The key among the doubts of those that are about the recording as a whole."""
MARKS = (keys.SEGMENT,)
"""The topic of what bounds a segment."""
NAMING = (keys.SEGMENT, keys.ACTION, keys.EVENT, keys.TRUTH)
"""The topics whose messages name a segment: its marks, its answers and its ground truth."""
Naming = Segment | Action | Event | Truth
"""Those messages."""
TORSO = INDEX["torso"]
T = TypeVar("T")


class Marked(Protocol):
    """A marked segment, of a sensor's frames; None for what its marks do not say. With a label it is an example."""

    @property
    def segment_id(self) -> str: ...  # noqa: D102
    @property
    def sensor(self) -> str: ...  # noqa: D102
    @property
    def start_ns(self) -> int | None: ...  # noqa: D102
    @property
    def end_ns(self) -> int | None: ...  # noqa: D102
    @property
    def agent(self) -> int | None: ...  # noqa: D102
    @property
    def label(self) -> str | None: ...  # noqa: D102
    @property
    def mirrored(self) -> bool: ...  # noqa: D102
    def has(self, message: Naming) -> bool: ...  # noqa: D102


M = TypeVar("M", bound=Marked)


class MixedMirroringError(ValueError):
    """Two segments that would share frames which one of them has mirrored; the text names both."""

    def __init__(self, one: Marked, other: Marked) -> None:
        mirrored, plain = (one, other) if one.mirrored else (other, one)
        super().__init__(
            f"{mirrored.segment_id} is mirrored and {plain.segment_id} is not, so they cannot share frames: "
            "trim them until they do not overlap, or mirror one of them first"
        )


def in_turn(*changes: Change) -> Change:
    """Return the change that makes several, one after the other."""

    def change(stored: StoredMessage) -> StoredMessage | None:
        for each in changes:
            changed = each(stored)
            if changed is None:
                return None
            stored = changed
        return stored

    return change


def without_messages(segments: Iterable[Marked], topics: Collection[keys.Topic] = NAMING) -> Change:
    """Return the change that leaves out what names these segments, on these topics."""
    gone = list(segments)

    def change(stored: StoredMessage) -> StoredMessage | None:
        message = decoded(stored, topics)
        names_one = isinstance(message, Naming) and any(each.has(message) for each in gone)
        return None if names_one else stored

    return change


def deleted(gone: Sequence[Marked], kept: Sequence[Marked]) -> Change:
    """Return the change that deletes segments: what names them, and the frames of whoever acts in the examples.

    Frames that a kept example of that person holds stay. One without a label was background, and is so afterwards.
    """
    examples = [each for each in gone if each.label is not None]
    return in_turn(without_messages(gone), _frames([*gone, *kept], kept, examples))


def following(before: Sequence[Marked], after: Sequence[Marked]) -> Change:
    """Return the change by which a recording's frames follow its segments, of which some are moved or mirrored."""
    return _frames(before, after, ())


def mirrored_with(one: M, segments: Sequence[M]) -> list[M]:
    """List the segments that can only be mirrored together with one: itself, and those that share frames, in turn."""
    together, others = [one], [each for each in segments if each is not one]
    for each in together:
        together += (joined := [other for other in others if _belong_together(each, other)])
        others = [other for other in others if other not in joined]
    return together


def refuse_mixed(one: Marked, others: Iterable[Marked]) -> None:
    """Refuse a segment that would share frames with another, where only one of both is mirrored.

    Raises:
        MixedMirroringError: there is such another.
    """
    for other in others:
        if one.mirrored != other.mirrored and _share_frames(one, other):
            raise MixedMirroringError(one, other)


def mirrored_ids(recording: Recording) -> list[str]:
    """Return the ids of the segments whose frames are stored mirrored."""
    return field_of(recording, MIRRORED, IDS, [])


def fields_after(recording: Recording, segments: Collection[Marked]) -> dict[str, str]:
    """Return the metadata of a recording that is to hold these segments: nothing is said about others."""
    ids = {OF_THE_TAKE, *(each.segment_id for each in segments)}
    doubts = field_of(recording, DOUBTS, TEXTS, {})
    fields = {
        DOUBTS: json.dumps({segment_id: texts for segment_id, texts in doubts.items() if segment_id in ids}),
        MIRRORED: mirrored_field(segments),
    }
    return {name: text for name, text in fields.items() if name in recording.metadata}


def mirrored_field(segments: Iterable[Marked]) -> str:
    """Return the metadata field of the segments that are mirrored."""
    return json.dumps(sorted({each.segment_id for each in segments if each.mirrored}))


def field_of(recording: Recording, name: str, form: TypeAdapter[T], default: T) -> T:
    """Return a field of the metadata that is JSON; one of another form, which only a foreign program writes, counts as
    none."""
    try:
        return form.validate_json(recording.metadata.get(name, ""))
    except ValidationError:
        return default


def _frames(before: Sequence[Marked], after: Sequence[Marked], gone: Sequence[Marked]) -> Change:
    """Return the change that takes people out of the frames of what is gone, and mirrors others anew."""
    needed = [each for each in after if each.label is not None]
    was, will = ([each for each in some if each.mirrored] for some in (before, after))

    def goes(agent: int, at: tuple[str, int]) -> bool:
        return _held(gone, agent, *at) and not _held(needed, agent, *at)

    def change(stored: StoredMessage) -> StoredMessage | None:
        if not any(_holds(each, None, stored.publish_ns) for each in (*was, *will, *gone)):
            return stored
        message = decoded(stored, (keys.SKELETON, keys.POSTURE))
        if message is None:
            return stored
        at = message.sensor, stored.publish_ns
        if isinstance(message, Posture):
            return None if goes(message.agent, at) else stored
        assert isinstance(message, Skeleton)
        agents = [
            each if _held(was, each.agent, *at) == _held(will, each.agent, *at) else mirror_image(each)
            for each in message.agents
            if not goes(each.agent, at)
        ]
        if agents == message.agents:
            return stored
        return replace(stored, payload=codec.encode(message.model_copy(update={"agents": agents})).payload)

    return change


def _held(segments: Iterable[Marked], agent: int, sensor: str, stamp_ns: int) -> bool:
    return any(each.sensor == sensor and _holds(each, agent, stamp_ns) for each in segments)


def _holds(segment: Marked, agent: int | None, stamp_ns: int) -> bool:
    """Tell whether a person's frame, or anybody's, belongs to a segment: its first and its last one do."""
    if segment.start_ns is None or segment.end_ns is None:
        return False
    return segment.start_ns <= stamp_ns <= segment.end_ns and (agent is None or segment.agent in (None, agent))


def _share_frames(one: Marked, other: Marked) -> bool:
    if one.start_ns is None or one.end_ns is None or other.start_ns is None or other.end_ns is None:
        return False
    same_person = one.agent is None or other.agent is None or one.agent == other.agent
    in_time = one.start_ns <= other.end_ns and other.start_ns <= one.end_ns
    return one.sensor == other.sensor and same_person and in_time


def _belong_together(one: Marked, other: Marked) -> bool:
    """Tell whether two segments share frames, or a name, by which alone the metadata know them."""
    return one.segment_id == other.segment_id or _share_frames(one, other)


def decoded(stored: StoredMessage, topics: Collection[keys.Topic]) -> Message | None:
    """Decode a message of these topics, None for any other. A mark without a stamp gets that of its storage."""
    try:
        if keys.parse(stored.key).topic not in topics:
            return None
        message = codec.decode(stored.key, stored.payload, stored.encoding)
    except (keys.InvalidKeyError, codec.DecodeError):
        return None
    return message if message.stamp_ns is not None else message.model_copy(update={"stamp_ns": stored.publish_ns})


def mirror_image(agent: Agent) -> Agent:
    """Return a person's mirror image where the person stands: about the plane through the torso to the camera's right.

    Where the torso is not known, the joints' middle stands for it; mirrored twice, everything is as it was.
    """
    known = [joint for joint in agent.joints if joint is not None]
    middle = agent.joints[TORSO] or [sum(joint[0] for joint in known) / max(len(known), 1)]
    joints = [None if joint is None else [2 * middle[0] - joint[0], *joint[1:]] for joint in agent.joints]
    update = {
        "joints": [joints[index] for index in OPPOSITE.tolist()],
        "confidence": [agent.confidence[index] for index in OPPOSITE.tolist()],
    }
    return agent.model_copy(update=update)
