"""Whether the samples of a segment have come: an object that is chosen without them may be the wrong one."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from actum.node import SECOND_NS

LOST_NS = SECOND_NS // 2
"""A part without samples that is no longer than this (ns) is interpolated well enough."""

LOST_SHARE = 0.25
"""So is one of no more than this share of the segment."""

LOST_INTERVALS = 4
"""So is one of no more than as many of the stream's usual intervals: a slow tracker is not a lost one."""


def why_postures_lost(stamps_ns: Sequence[int], start_ns: int, end_ns: int, resumed: bool) -> str | None:
    """Return the reason for which postures do not reach over a segment; None where they do.

    Gaps between them are none of it: the classifier, who knows which frames were captured, has let them pass.

    Args:
        stamps_ns: of all people's postures, one or more, rising, from some time before the segment on.
        start_ns: the segment's start.
        end_ns: its end.
        resumed: whether another process was there before this one, so that there were postures before the first.
    """
    least_ns = max(LOST_NS, LOST_SHARE * (end_ns - start_ns))
    late_ns = stamps_ns[0] - start_ns
    if resumed and late_ns > least_ns:
        return f"the fusion was not there: its first posture is {late_ns / SECOND_NS:.1f} s after the start"
    return _why_missing("postures", [(stamps_ns[-1], end_ns)], start_ns, least_ns)


def why_objects_lost(stamps_ns: Sequence[int], start_ns: int, end_ns: int) -> str | None:
    """Return the reason for which a stream of objects does not cover a segment; None where it does.

    Args:
        stamps_ns: the stream's stamps, one or more, rising, from some time before the segment on.
        start_ns: the segment's start.
        end_ns: its end.
    """
    usual_ns = float(np.median(np.diff(stamps_ns))) if len(stamps_ns) > 1 else 0.0
    least_ns = max(LOST_NS, LOST_SHARE * (end_ns - start_ns), LOST_INTERVALS * usual_ns)
    gaps_ns = ((before, min(then, end_ns)) for before, then in pairwise([*stamps_ns, end_ns]))
    late_ns = stamps_ns[0] - start_ns
    if late_ns > least_ns:
        return f"objects lost: the first came {late_ns / SECOND_NS:.1f} s after the start"
    return _why_missing("objects", gaps_ns, start_ns, least_ns)


def _why_missing(what: str, gaps_ns: Iterable[tuple[int, int]], start_ns: int, least_ns: float) -> str | None:
    lost_ns = max(then_ns - max(before_ns, start_ns) for before_ns, then_ns in gaps_ns)
    return f"{what} lost: none came for {lost_ns / SECOND_NS:.1f} s of the segment" if lost_ns > least_ns else None
