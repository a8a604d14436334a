"""A take of a set: one recording with the marks of its examples; how it is finished, and what is read from it."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from math import inf
from pathlib import Path
from typing import Literal

from actum import keys
from actum.codec import encodable
from actum.messages import CUT, MANUAL, Action, Event, Hand, Segment
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum.recording import Recording, RecordingError
from actum.rewriting import rewrite, unchanged
from actum_examples.cutting.marks import free_names, marks_of
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts
from actum_examples.edits import DOUBTS, OF_THE_TAKE, TEXTS, Naming, deleted, field_of, mirrored_ids

KIND, CREATED = "kind", "created"
"""Fields of a take's metadata, beside those that say something about its examples: kind and date."""
AGAIN = "again"
"""The start mark with which a segment's name is used again, among its marks by kind."""
UNCUT = "uncut"
"""What a part of a take is called that may hold an action which was not cut."""
MOST_EXAMPLES = 2000
"""Most examples of a take, some hours of actions: a change of one looks at all others, while the service waits."""
UNREAD = "skipped while it was read: "
"""How the doubt about what was skipped begins; it is found anew each time, and never stored."""


@dataclass(frozen=True)
class Example:
    """One marked action of a take.

    Attributes:
        agent: who acts; None where the mark leaves that to the classifier.
        origin: who marked it.
        mirrored: whether left and right have been exchanged.
        doubts: what may be wrong with it, in sentences.
        hand: which hand acts; None where the mark does not say so.
        until_ns: from when on its name is used again, for another segment, which is no example.
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
    hand: Hand | None = None
    until_ns: float = inf

    @property
    def id(self) -> str:
        """What commands call it."""
        return f"{self.take}/{self.segment_id}"

    def has(self, message: Naming) -> bool:
        """Tell whether a message names it."""
        if (message.sensor, message.segment_id) != (self.sensor, self.segment_id):
            return False
        at_ns = message.start_ns if isinstance(message, Action | Event) else message.stamp_ns
        return at_ns is None or at_ns < self.until_ns

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
        RecordingError: the file is no recording, damaged, or has too many examples.
    """
    recording = Recording(path)
    marks, stamps_ns = _marks_and_stamps(recording)
    doubts, mirrored = field_of(recording, DOUBTS, TEXTS, {}), mirrored_ids(recording)
    examples = [
        _example(encodable(path.stem), recording.person, pair, doubts, mirrored)
        for pair in marks.values()
        if {"start", "end"} <= pair.keys() and pair["start"].label is not None
    ]
    if len(examples) > MOST_EXAMPLES:
        raise RecordingError(path, f"it has {len(examples)} marked actions, more than {MOST_EXAMPLES}", "split it")
    return Take(
        encodable(path.stem),
        path,
        "background" if recording.metadata.get(KIND) == "background" else "action",
        recording.person,
        recording.metadata.get(CREATED, ""),
        min(stamps_ns, default=0),
        max(stamps_ns, default=0),
        tuple(sorted(examples, key=lambda example: example.start_ns)),
        (*doubts.get(OF_THE_TAKE, ()), *_unread(recording)),
    )


def finish_take(
    recorder: Recorder, marks: Iterable[Segment], doubts: Mapping[str, Sequence[str]], uncut: Sequence[Example] = ()
) -> Path:
    """Close a take, and return its path.

    Args:
        recorder: of its frames.
        marks: of its examples.
        doubts: what may be wrong with them, texts by segment id.
        uncut: the parts from which whoever acts is taken out, or they would be learnt as background.

    Raises:
        OSError: it cannot be written.
    """
    recorder.close()
    rewrite(recorder.path, deleted(uncut, ()) if uncut else unchanged, marks, {DOUBTS: doubts_field(doubts)})
    return recorder.path


def uncut_parts(cuts: Cuts, asked: int | None, sensor: str) -> list[Example]:
    """Return the parts of a take in which the person may have done the action though no example was cut of it.

    There are none where the cuts are sure and as many as were asked for: then all other movement is background.
    """
    if cuts.sureness > OTHER_NUMBER and asked in (None, len(cuts.repetitions)):
        return []
    return [
        Example("", UNCUT, sensor, UNCUT, "", start_ns, end_ns, cuts.course.agent, CUT, mirrored=False, doubts=())
        for start_ns, end_ns in cuts.uncut_ns
    ]


def cut_marks(cuts: Cuts, label: str, sensor: str) -> tuple[list[Segment], dict[str, list[str]]]:
    """Return the marks of what was cut, and what may be wrong with them by segment id."""
    names = list(islice(free_names((), CUT), len(cuts.repetitions)))
    doubts: dict[str, list[str]] = {}
    for text, repetition in cuts.doubted:
        doubts.setdefault(OF_THE_TAKE if repetition is None else names[repetition - 1], []).append(text)
    return marks_of(cuts, iter(names), label, sensor), doubts


def doubts_field(doubts: Mapping[str, Sequence[str]]) -> str:
    """Return the metadata field of doubts, from texts by segment id."""
    return json.dumps(
        {
            segment_id: [text for text in texts if not text.startswith(UNREAD)]
            for segment_id, texts in doubts.items()
            if texts
        }
    )


def _marks_and_stamps(recording: Recording) -> tuple[dict[tuple[str, str], dict[str, Segment]], list[int]]:
    """Return the first marks of each segment by their kind, and the stamps of the frames (ns)."""
    marks: dict[tuple[str, str], dict[str, Segment]] = {}
    stamps_ns: list[int] = []
    for message in recording.messages((keys.SKELETON, keys.SEGMENT)):
        if isinstance(message, Segment):
            pair = marks.setdefault((message.sensor, message.segment_id), {})
            again = message.kind == "start" and "end" in pair
            pair.setdefault(AGAIN if again else message.kind, message)
        else:
            stamps_ns.append(message.stamp_ns)
    return marks, stamps_ns


def _unread(recording: Recording) -> list[str]:
    """Return what was skipped of a take, as a doubt."""
    kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(recording.skipped.items()))
    return [f"{UNREAD}{kinds}"] if kinds else []


def _example(
    take: str,
    person: str,
    pair: Mapping[str, Segment],
    doubts: Mapping[str, Sequence[str]],
    mirrored: Iterable[str],
) -> Example:
    start, end, again = pair["start"], pair["end"], pair.get(AGAIN)
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
        start.hand,
        inf if again is None or again.stamp_ns is None else again.stamp_ns,
    )
