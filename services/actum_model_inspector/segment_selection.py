"""Which segments are worth a picture: a typical one of each action, and the mistakes that were surest."""

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import count

from actum_model_inspector.answered import AnsweredSegment

MOST_MISTAKES = 5
_LONGEST_NAME = 50


def examples(segments: Sequence[AnsweredSegment]) -> dict[str, AnsweredSegment]:
    """Choose for each action, by label or else by answer, the right answer of median confidence, else the surest wrong.

    Rejected segments show nothing; an action that has no others is left out.
    """
    groups: dict[str, list[AnsweredSegment]] = {}
    for segment in segments:
        if segment.recognition is not None:
            groups.setdefault(segment.label or segment.recognition.label, []).append(segment)
    return {action: _typical(groups[action]) for action in sorted(groups)}


def mistakes(segments: Sequence[AnsweredSegment]) -> list[AnsweredSegment]:
    """Return the wrong answers that were surest, one for each pair of actions, the surest first."""
    surest: dict[tuple[str | None, str], AnsweredSegment] = {}
    for segment in sorted(segments, key=_confidence, reverse=True):
        if segment.recognition is not None and segment.label is not None and not segment.correct:
            surest.setdefault((segment.label, segment.recognition.label), segment)
    return list(surest.values())[:MOST_MISTAKES]


def file_names(actions: Iterable[str]) -> Mapping[str, str]:
    """Return for each action a part of a file name, no two alike on any file system."""
    names: dict[str, str] = {}
    taken = {mistake_name(number) for number in range(1, MOST_MISTAKES + 1)}
    for action in actions:
        plain = re.sub(r"[^\w]+", "-", action.lower()).strip("-")[:_LONGEST_NAME] or "action"
        candidates = (plain if number == 1 else f"{plain}-{number}" for number in count(1))
        names[action] = next(name for name in candidates if name not in taken)
        taken.add(names[action])
    return names


def mistake_name(number: int) -> str:
    """Return the part of a file name that stands for a mistake."""
    return f"mistake-{number}"


def _typical(segments: Sequence[AnsweredSegment]) -> AnsweredSegment:
    ranked = sorted(segments, key=_confidence)
    right = [segment for segment in ranked if segment.correct or segment.label is None]
    return right[len(right) // 2] if right else ranked[-1]


def _confidence(segment: AnsweredSegment) -> float:
    return segment.recognition.confidence if segment.recognition is not None else 0.0
