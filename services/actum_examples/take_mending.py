"""Mends the takes of a set: each change replaces the file as a whole, and its frames follow its examples."""

from collections.abc import Sequence
from dataclasses import replace

from actum.messages import MANUAL, Hand, segment_marks
from actum.rewriting import rewrite
from actum_examples.edits import (
    DOUBTS,
    MARKS,
    MIRRORED,
    OF_THE_TAKE,
    deleted,
    following,
    in_turn,
    mirrored_field,
    mirrored_with,
    refuse_mixed,
    without_messages,
)
from actum_examples.take import Example, Take, doubts_field

OTHER: dict[Hand | None, Hand | None] = {"left": "right", "right": "left", None: None}
"""The hand that acts in a mirror."""


def relabel(take: Take, example: Example, label: str) -> None:
    """Give an example another label.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """
    _mend(take, [example], [replace(example, label=label)])


def trim(take: Take, example: Example, start_ns: int, end_ns: int) -> None:
    """Give an example another start and end; what was doubted about it is settled by that.

    Raises:
        MixedMirroringError: it would share frames with one that is mirrored, and is not itself, or the other way round.
        OSError: the file cannot be written; it is as it was.
    """
    trimmed = replace(example, start_ns=start_ns, end_ns=end_ns, origin=MANUAL, doubts=())
    refuse_mixed(trimmed, (each for each in take.examples if each is not example))
    _mend(take, [example], [trimmed])


def mirror(take: Take, example: Example) -> None:
    """Exchange left and right of whoever acts in an example, and in those that share frames with it.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """
    together = mirrored_with(example, take.examples)
    mirrored = not example.mirrored
    _mend(
        take,
        together,
        [
            each if each.mirrored == mirrored else replace(each, mirrored=mirrored, hand=OTHER[each.hand])
            for each in together
        ],
    )


def without(take: Take, examples: Sequence[Example]) -> None:
    """Delete examples, as `actum label delete` does: their marks, and the frames of whoever acts in them.

    Raises:
        OSError: the file cannot be written; it is as it was.
    """
    kept = [each for each in take.examples if each not in examples]
    rewrite(take.path, deleted(examples, kept), metadata=_fields(take, kept))


def _mend(take: Take, old: Sequence[Example], new: Sequence[Example]) -> None:
    """Put examples in the place of others; the frames follow."""
    after = [*(each for each in take.examples if each not in old), *new]
    change = in_turn(without_messages(old, MARKS), following(take.examples, after))
    marks = [
        mark
        for each in new
        for mark in segment_marks(
            each.start_ns, each.end_ns, each.sensor, each.segment_id, each.label, each.agent, each.hand, each.origin
        )
    ]
    rewrite(take.path, change, marks, _fields(take, after))


def _fields(take: Take, examples: Sequence[Example]) -> dict[str, str]:
    doubts = {OF_THE_TAKE: take.doubts} | {each.segment_id: each.doubts for each in examples}
    return {DOUBTS: doubts_field(doubts), MIRRORED: mirrored_field(examples)}
