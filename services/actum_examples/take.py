"""A take: one recording with its marked segments, and what its metadata say about them."""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, TypeVar

from pydantic import TypeAdapter, ValidationError

from actum import keys
from actum.codec import encodable
from actum.messages import Segment, is_action
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_examples.marked_segment import MarkedSegment, marked_segments

KIND, CREATED = "kind", "created"
"""Fields of a recording's metadata: whether it was made for an action or for background, and its date (ISO 8601)."""
DOUBTS, MIRRORED = "doubts", "mirrored"
"""Fields of a recording's metadata: doubts (texts by segment id) and mirrored segment ids, as JSON."""
TEXTS, IDS = TypeAdapter(dict[str, list[str]]), TypeAdapter(list[str])
"""The forms of these."""
OF_THE_TAKE = ""
"""The key among the doubts of those that are about the recording as a whole."""
UNREAD = "skipped while it was read: "
"""How the doubt about what was skipped begins; it is found anew each time, and never stored."""
T = TypeVar("T")


@dataclass(frozen=True)
class Take:
    """A recording with its marked segments.

    Attributes:
        recording: the file.
        segments: in order of start.
        first_ns: stamp of the first frame; without frames, of the first mark; 0 without either.
        last_ns: stamp of the last one.
        doubts: what may be wrong with the recording as a whole, in sentences.
    """

    recording: Recording
    segments: tuple[MarkedSegment, ...]
    first_ns: int
    last_ns: int
    doubts: tuple[str, ...]

    @property
    def path(self) -> Path:
        """The file."""
        return self.recording.path

    @property
    def id(self) -> str:
        """The name of the file without its ending."""
        return encodable(self.path.stem)

    @property
    def person(self) -> str:
        """Who acts; empty where the file does not say."""
        return self.recording.person

    @property
    def kind(self) -> Literal["action", "background"]:
        """What it was recorded for."""
        return "background" if self.recording.metadata.get(KIND) == "background" else "action"

    @property
    def created(self) -> str:
        """When it was made (ISO 8601); empty where the file does not say."""
        return self.recording.metadata.get(CREATED, "")

    @property
    def examples(self) -> list[MarkedSegment]:
        """The segments that training can learn from. Of a name that is used again, the first use counts."""
        by_name = {(each.sensor, each.segment_id): each for each in reversed(self.segments)}
        return [each for each in self.segments if each.is_example and by_name[each.sensor, each.segment_id] is each]

    @property
    def labels(self) -> list[str]:
        """The action of each example that shows one."""
        return [each.label for each in self.examples if is_action(each.label)]

    @property
    def background_s(self) -> float:
        """For how long nobody did any of the actions (s)."""
        bounds_ns = [each.bounds_ns for each in self.examples]
        marked_ns = sum(bounds[1] - bounds[0] for bounds in bounds_ns if bounds is not None)
        return max(0.0, (self.last_ns - self.first_ns - marked_ns) / SECOND_NS)

    def name_of(self, segment: MarkedSegment) -> str:
        """Return what commands call a segment of it."""
        return f"{self.id}/{segment.segment_id}"

    def fields_with(self, segments: Collection[MarkedSegment]) -> dict[str, str]:
        """Return the metadata of the recording once it holds these segments."""
        doubts = {OF_THE_TAKE: self.doubts} | {each.segment_id: each.doubts for each in segments}
        mirrored = sorted({each.segment_id for each in segments if each.mirrored})
        fields = {DOUBTS: doubts_field(doubts), MIRRORED: json.dumps(mirrored)}
        known = self.recording.metadata
        return {name: text for name, text in fields.items() if name in known or json.loads(text)}


def read_take(recording: Recording) -> Take:
    """Read a recording as a take.

    Raises:
        RecordingError: the file is damaged.
    """
    marks: list[Segment] = []
    stamps_ns: list[int] = []
    for message in recording.messages((frames_topic(recording), keys.SEGMENT)):
        if isinstance(message, Segment):
            marks.append(message)
        elif message.stamp_ns is not None:
            stamps_ns.append(message.stamp_ns)
    stamps_ns = stamps_ns or [mark.stamp_ns for mark in marks if mark.stamp_ns is not None]
    doubts, mirrored = _field(recording, DOUBTS, TEXTS, {}), _field(recording, MIRRORED, IDS, [])
    segments = tuple(
        replace(each, mirrored=each.segment_id in mirrored, doubts=tuple(doubts.get(each.segment_id, ())))
        for each in marked_segments(marks)
    )
    skipped = ", ".join(f"{kind} {count}" for kind, count in sorted(recording.skipped.items()))
    unread = [f"{UNREAD}{skipped}"] if skipped else []
    of_take = (*doubts.get(OF_THE_TAKE, ()), *unread)
    return Take(recording, segments, min(stamps_ns, default=0), max(stamps_ns, default=0), of_take)


def frames_topic(recording: Recording) -> keys.Topic:
    """Return the topic that people are seen in: a recording of made-up postures has no skeletons."""
    return keys.SKELETON if keys.SKELETON in recording.topics else keys.POSTURE


def doubts_field(doubts: Mapping[str, Sequence[str]]) -> str:
    """Return the metadata field of doubts, from texts by segment id."""
    stored = {name: [text for text in texts if not text.startswith(UNREAD)] for name, texts in doubts.items()}
    return json.dumps({name: texts for name, texts in stored.items() if texts})


def _field(recording: Recording, name: str, form: TypeAdapter[T], default: T) -> T:
    """Return a field of the metadata that is JSON; one of another form, which only a foreign program writes, counts as
    none."""
    try:
        return form.validate_json(recording.metadata.get(name, ""))
    except ValidationError:
        return default
