"""A take of a set: one recording with the marks of its examples; what is read from it, and how it is mended."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Literal, TypeVar

from pydantic import TypeAdapter, ValidationError

from actum import codec, keys
from actum.mcap_file import StoredMessage
from actum.messages import CUT, MANUAL, Agent, Segment, Skeleton, segment_marks
from actum.node import SECOND_NS
from actum.recording import Recorder, Recording
from actum.rewriting import Change, rewrite, unchanged
from actum.skeletons import INDEX
from actum_model_trainer.cutting.marks import free_names, marks_of
from actum_model_trainer.cutting.repetitions import Cuts
from som_classifier.handedness import OPPOSITE

KIND, CREATED, DOUBTS, MIRRORED = "kind", "created", "doubts", "mirrored"
"""Fields of a take's metadata: kind and date; doubts (texts by segment id) and mirrored segment ids, as JSON."""
OF_THE_TAKE = ""
"""The key among the doubts of those that are about the take as a whole."""
TEXTS, IDS = TypeAdapter(dict[str, list[str]]), TypeAdapter(list[str])
"""The forms of these."""
TORSO = INDEX["torso"]
T = TypeVar("T")


@dataclass(frozen=True)
class Example:
    """One marked action of a take.

    Attributes:
        agent: who acts; None where the mark leaves that to the classifier.
        origin: who marked it.
        mirrored: whether left and right have been exchanged.
        doubts: what may be wrong with it, in sentences.
    """

    take: str
    segment_id: str
    sensor: str
    label: str
    person: str
    start_ns: int
    end_ns: int
    agent: int | None
    origin: str
    mirrored: bool
    doubts: tuple[str, ...]

    @property
    def id(self) -> str:
        """What commands call it."""
        return f"{self.take}/{self.segment_id}"

    def overlaps(self, start_ns: int, end_ns: int) -> bool:
        """Tell whether it shares time with a span."""
        return self.start_ns < end_ns and start_ns < self.end_ns


@dataclass(frozen=True)
class Take:
    """What a recording of a set holds; times are stamps of its frames."""

    id: str
    path: Path
    kind: Literal["action", "background"]
    person: str
    created: str
    first_ns: int
    last_ns: int
    examples: tuple[Example, ...]
    doubts: tuple[str, ...]

    @property
    def background_s(self) -> float:
        """For how long nobody did any of the actions (s)."""
        marked_ns = sum(example.end_ns - example.start_ns for example in self.examples)
        return max(0.0, (self.last_ns - self.first_ns - marked_ns) / SECOND_NS)


def read_take(path: Path) -> Take:
    """Read a take.

    Raises:
        RecordingError: the file is no recording, or damaged.
    """
    recording = Recording(path)
    marks: dict[tuple[str, str], dict[str, Segment]] = {}
    stamps_ns: list[int] = []
    for message in recording.messages((keys.SKELETON, keys.SEGMENT)):
        if isinstance(message, Segment):
            marks.setdefault((message.sensor, message.segment_id), {}).setdefault(message.kind, message)
        else:
            stamps_ns.append(message.stamp_ns)
    doubts, mirrored = _field(recording, DOUBTS, TEXTS, {}), _field(recording, MIRRORED, IDS, [])
    examples = [
        _example(path.stem, recording.person, pair["start"], pair["end"], doubts, mirrored)
        for pair in marks.values()
        if {"start", "end"} <= pair.keys() and pair["start"].label is not None
    ]
    return Take(
        path.stem,
        path,
        "background" if recording.metadata.get(KIND) == "background" else "action",
        recording.person,
        recording.metadata.get(CREATED, ""),
        min(stamps_ns, default=0),
        max(stamps_ns, default=0),
        tuple(sorted(examples, key=lambda example: example.start_ns)),
        tuple(doubts.get(OF_THE_TAKE, ())),
    )


def finish_take(recorder: Recorder, marks: Iterable[Segment], doubts: Mapping[str, Sequence[str]]) -> Path:
    """Close a take with its marks and what may be wrong with them, texts by segment id; return its path.

    Raises:
        OSError: it cannot be written.
    """
    recorder.close()
    rewrite(recorder.path, unchanged, marks, {DOUBTS: doubts_field(doubts)})
    return recorder.path


def cut_marks(cuts: Cuts, label: str, sensor: str) -> tuple[list[Segment], dict[str, list[str]]]:
    """Return the marks of what was cut, and what may be wrong with them by segment id."""
    names = list(islice(free_names((), CUT), len(cuts.repetitions)))
    doubts: dict[str, list[str]] = {}
    for text, repetition in cuts.doubted:
        doubts.setdefault(OF_THE_TAKE if repetition is None else names[repetition - 1], []).append(text)
    return marks_of(cuts, iter(names), label, sensor), doubts


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


def doubts_field(doubts: Mapping[str, Sequence[str]]) -> str:
    """Return the metadata field of doubts, from texts by segment id."""
    return json.dumps({segment_id: list(texts) for segment_id, texts in doubts.items() if texts})


def _replace_marks(take: Take, old: Example, new: Example) -> None:
    change: Change = lambda stored: None if _is_mark_of(stored, old) else stored  # noqa: E731 - a line
    marks = segment_marks(new.start_ns, new.end_ns, new.sensor, new.segment_id, new.label, new.agent, origin=new.origin)
    kept = {each.segment_id: each.doubts for each in take.examples} | {new.segment_id: new.doubts}
    rewrite(take.path, change, marks, _doubts(take, kept))


def _doubts(take: Take, of_examples: Mapping[str, Sequence[str]]) -> dict[str, str]:
    return {DOUBTS: doubts_field({OF_THE_TAKE: take.doubts, **of_examples})}


def _example(
    take: str,
    person: str,
    start: Segment,
    end: Segment,
    doubts: Mapping[str, Sequence[str]],
    mirrored: Iterable[str],
) -> Example:
    assert start.stamp_ns is not None and end.stamp_ns is not None
    return Example(
        take,
        start.segment_id,
        start.sensor,
        start.label or "",
        person,
        start.stamp_ns,
        end.stamp_ns,
        start.agent,
        start.origin or MANUAL,
        start.segment_id in mirrored,
        tuple(doubts.get(start.segment_id, ())),
    )


def _field(recording: Recording, name: str, form: TypeAdapter[T], default: T) -> T:
    """Return a field of the metadata that is JSON; one of another form, which only a foreign program writes, counts as
    none."""
    try:
        return form.validate_json(recording.metadata.get(name, ""))
    except ValidationError:
        return default


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
