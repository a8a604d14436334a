"""What becomes of the stored messages of a recording whose marked segments are deleted, moved or mirrored.

The frames follow the segments by one rule: a person's frame is stored mirrored where, and only where, a mirrored
segment of that person holds it. A deleted example takes the frames of whoever acts in it away, or they would be learnt
as background; frames that another example of that person holds stay.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from actum import codec, keys
from actum.mcap_file import StoredMessage
from actum.messages import Agent, Message, Posture, Segment, Skeleton
from actum.rewriting import Change
from actum.skeletons import INDEX
from actum_examples.marked_segment import MarkedSegment, Naming
from som_classifier.handedness import OPPOSITE

NAMING = (keys.SEGMENT, keys.ACTION, keys.EVENT, keys.INTENT, keys.TRUTH)
"""The topics whose messages name a segment."""
TORSO = INDEX["torso"]


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


def without_messages(segments: Iterable[MarkedSegment]) -> Change:
    """Return the change that leaves out what names these segments: marks, answers, intents and ground truth."""
    gone = list(segments)

    def change(stored: StoredMessage) -> StoredMessage | None:
        message = _decoded(stored, NAMING)
        names_one = isinstance(message, Naming) and any(each.has(message) for each in gone)
        return None if names_one else stored

    return change


def deleted(gone: Sequence[MarkedSegment], kept: Sequence[MarkedSegment]) -> Change:
    """Return the change that deletes segments: what names them, and the frames of whoever acts in the examples.

    Frames that a kept example of that person holds stay. One without a label was background, and is so afterwards.
    """
    examples = [each for each in gone if each.label is not None]
    return in_turn(without_messages(gone), following([*gone, *kept], kept, examples))


def remarked(old: MarkedSegment, new: MarkedSegment) -> Change:
    """Return the change that gives the marks of a segment another label, bounds, hand or origin."""

    def change(stored: StoredMessage) -> StoredMessage | None:
        mark = _decoded(stored, (keys.SEGMENT,))
        if not isinstance(mark, Segment) or not old.has(mark):
            return stored
        stamp_ns = new.start_ns if mark.kind == "start" else new.end_ns
        assert stamp_ns is not None
        label = new.label if mark.kind == "start" else mark.label
        update = {"stamp_ns": stamp_ns, "label": label, "hand": new.hand, "origin": new.origin}
        return replace(stored, payload=codec.encode(mark.model_copy(update=update)).payload, publish_ns=stamp_ns)

    return change


def mirrored_with(one: MarkedSegment, segments: Sequence[MarkedSegment]) -> list[MarkedSegment]:
    """List the segments that can only be mirrored together with one: itself, and those that share frames, in turn.

    Also those that share its name, by which alone the metadata know them.
    """
    together, others = [one], [each for each in segments if each is not one]
    for each in together:
        joined = [other for other in others if each.segment_id == other.segment_id or each.shares_frames(other)]
        together += joined
        others = [other for other in others if other not in joined]
    return together


def following(
    before: Sequence[MarkedSegment], after: Sequence[MarkedSegment], gone: Sequence[MarkedSegment] = ()
) -> Change:
    """Return the change by which a recording's frames follow its segments, of which some are moved or mirrored.

    People are taken out of the frames of the examples that are gone.
    """
    needed = [each for each in after if each.label is not None]
    was, will = ([each for each in some if each.mirrored] for some in (before, after))

    def goes(agent: int, at: tuple[str, int]) -> bool:
        return _held(gone, agent, *at) and not _held(needed, agent, *at)

    def change(stored: StoredMessage) -> StoredMessage | None:
        if not any(each.holds(None, stored.publish_ns) for each in (*was, *will, *gone)):
            return stored
        message = _decoded(stored, (keys.SKELETON, keys.POSTURE))
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


def _held(segments: Iterable[MarkedSegment], agent: int, sensor: str, stamp_ns: int) -> bool:
    return any(each.sensor == sensor and each.holds(agent, stamp_ns) for each in segments)


def _decoded(stored: StoredMessage, topics: Collection[keys.Topic]) -> Message | None:
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
