"""Mends the takes of a set: each change replaces the file as a whole."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

from actum import codec, keys
from actum.mcap_file import StoredMessage
from actum.messages import MANUAL, Agent, Segment, Skeleton, segment_marks
from actum.rewriting import Change, rewrite
from actum.skeletons import INDEX
from actum_model_trainer.teaching.take_files import DOUBTS, MIRRORED, OF_THE_TAKE, Example, Take, doubts_field
from som_classifier.handedness import OPPOSITE

TORSO = INDEX["torso"]


def relabel(take: Take, example: Example, label: str) -> None:
    """Give an example another label.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """
    _replace_marks(take, example, replace(example, label=label))


def trim(take: Take, example: Example, start_ns: int, end_ns: int) -> None:
    """Give an example another start and end; what was doubted about it is settled by that.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """
    trimmed = replace(example, start_ns=start_ns, end_ns=end_ns, origin=MANUAL, doubts=())
    _replace_marks(take, example, trimmed)


def mirror(take: Take, example: Example) -> None:
    """Exchange left and right of whoever acts, in the frames of an example.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """
    changed = {each.segment_id for each in take.examples if each.mirrored} ^ {example.segment_id}

    def change(stored: StoredMessage) -> StoredMessage | None:
        skeleton = _skeleton_within(stored, example)
        if skeleton is None:
            return stored
        agents = [_mirrored(agent) if _acts(agent, example) else agent for agent in skeleton.agents]
        return _with_agents(stored, skeleton, agents)

    rewrite(take.path, change, metadata={MIRRORED: json.dumps(sorted(changed))})


def without(take: Take, examples: Sequence[Example]) -> None:
    """Take examples out: their marks, and whoever acts out of their frames, or they would be learnt as background.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """

    def change(stored: StoredMessage) -> StoredMessage | None:
        for example in examples:
            if _is_mark_of(stored, example):
                return None
            skeleton = _skeleton_within(stored, example)
            if skeleton is not None:
                stored = _with_agents(stored, skeleton, [each for each in skeleton.agents if not _acts(each, example)])
        return stored

    gone = {example.segment_id for example in examples}
    kept = {each.segment_id: each.doubts for each in take.examples if each.segment_id not in gone}
    rewrite(take.path, change, metadata=_doubts(take, kept))


def _replace_marks(take: Take, old: Example, new: Example) -> None:
    change: Change = lambda stored: None if _is_mark_of(stored, old) else stored  # noqa: E731 - a line
    marks = segment_marks(new.start_ns, new.end_ns, new.sensor, new.segment_id, new.label, new.agent, origin=new.origin)
    kept = {each.segment_id: each.doubts for each in take.examples} | {new.segment_id: new.doubts}
    rewrite(take.path, change, marks, _doubts(take, kept))


def _doubts(take: Take, of_examples: Mapping[str, Sequence[str]]) -> dict[str, str]:
    return {DOUBTS: doubts_field({OF_THE_TAKE: take.doubts, **of_examples})}


def _is_mark_of(stored: StoredMessage, example: Example) -> bool:
    if stored.key != keys.key(keys.SEGMENT, example.sensor):
        return False
    try:
        mark = codec.decode(stored.key, stored.payload, stored.encoding)
    except codec.DecodeError:
        return False
    return isinstance(mark, Segment) and mark.segment_id == example.segment_id


def _skeleton_within(stored: StoredMessage, example: Example) -> Skeleton | None:
    """Return the skeleton that is stored, where it is a frame of an example."""
    within = example.start_ns <= stored.publish_ns <= example.end_ns
    if not within or stored.key != keys.key(keys.SKELETON, example.sensor):
        return None
    try:
        message = codec.decode(stored.key, stored.payload, stored.encoding)
    except codec.DecodeError:
        return None
    return message if isinstance(message, Skeleton) else None


def _acts(agent: Agent, example: Example) -> bool:
    return example.agent in (None, agent.agent)


def _with_agents(stored: StoredMessage, skeleton: Skeleton, agents: list[Agent]) -> StoredMessage:
    return replace(stored, payload=codec.encode(skeleton.model_copy(update={"agents": agents})).payload)


def _mirrored(agent: Agent) -> Agent:
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
