"""The segments that get pictures: an example of each action, and the mistakes of the highest confidence."""

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import count

from actum_model_inspector.answered import AnsweredSegment

MAX_MISTAKES = 5  # with two pictures each: more nobody looks at
_MAX_NAME_LENGTH = 50  # letters: file systems allow 255 bytes, of up to four a letter, for the whole name


def examples(segments: Sequence[AnsweredSegment]) -> dict[str, AnsweredSegment]:
    """Choose a segment for each action: the right answer of median confidence, else the wrong one of the highest.

    A segment without a label counts as one of the action answered. Rejected segments are left out.
    """
    groups: dict[str, list[AnsweredSegment]] = {}
    for segment in segments:
        if segment.recognition is not None:
            groups.setdefault(segment.label or segment.recognition.label, []).append(segment)
    return {action: _example(groups[action]) for action in sorted(groups)}


def mistakes(segments: Sequence[AnsweredSegment]) -> list[AnsweredSegment]:
    """Return the wrong answers of the highest confidence, falling, one for each action done and action answered."""
    surest: dict[tuple[str | None, str], AnsweredSegment] = {}
    for segment in sorted(segments, key=_confidence, reverse=True):
        if segment.recognition is not None and segment.label is not None and not segment.correct:
            surest.setdefault((segment.label, segment.recognition.label), segment)
    return list(surest.values())[:MAX_MISTAKES]


def file_names(actions: Iterable[str]) -> Mapping[str, str]:
    """Return a part of a file name for each action, no two alike on any file system."""
    names: dict[str, str] = {}
    taken = {mistake_name(number) for number in range(1, MAX_MISTAKES + 1)}
    for action in actions:
        plain = re.sub(r"[^\w]+", "-", action.lower()).strip("-")[:_MAX_NAME_LENGTH] or "action"
        candidates = (plain if number == 1 else f"{plain}-{number}" for number in count(1))
        names[action] = next(name for name in candidates if name not in taken)
        taken.add(names[action])
    return names


def mistake_name(number: int) -> str:
    """Return the part of a file name for the mistake of this number, from 1."""
    return f"mistake-{number}"


def _example(segments: Sequence[AnsweredSegment]) -> AnsweredSegment:
    ranked = sorted(segments, key=_confidence)
    right = [segment for segment in ranked if segment.correct or segment.label is None]
    return right[len(right) // 2] if right else ranked[-1]


def _confidence(segment: AnsweredSegment) -> float:
    return segment.recognition.confidence if segment.recognition is not None else 0.0
