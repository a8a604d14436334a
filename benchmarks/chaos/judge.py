"""Judges a run: every marked segment has one answer, right or rejected for a reason that is true; a pure step."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

from actum.messages import Event

from .faults import CAMERA_HOST, LINK, ROUTERS
from .hearing import Heard, told
from .marking import Marked
from .recovery import Strike

Verdict = Literal["right", "rejected", "lost", "answered twice", "wrong", "untrue reason"]
ALLOWED: tuple[Verdict, ...] = ("right", "rejected")
"""The verdicts that are no violation."""
LOOK_BACK_S = 10.0
"""How long before a segment what went on may still show in it (s): where objects were, which way somebody stood."""
BACKLOG_S = 1.0
"""How long after all works again the backlog may take (s): until then a fault may explain a rejection."""
FRAMES = ("sensor_gateway", "pose_preprocessor", "som_classifier", *ROUTERS, LINK)
"""Those by whose fault the classifier may lack frames."""
OBJECTS = (*CAMERA_HOST, "action_fusion", *ROUTERS, LINK)
"""Those by whose fault it may be unknown where the objects were."""
REASONS: Mapping[str, Collection[str]] = {
    "the source started anew": ("sensor_gateway killed",),
    "the classifier started late": ("som_classifier killed",),
    "the fusion started late": ("action_fusion killed",),
    "frames lost": FRAMES,
    "no person": FRAMES,
    "no usable frame": FRAMES,
    "too few frames": FRAMES,
    "postures lost": ("action_fusion", *FRAMES),
    "objects lost": OBJECTS,
}
"""How reasons begin that a fault makes true, each with victims, or a victim and what befell it.

That a start or an end of a mark was missing is never true: the client put both, and was there to put them again.
"""


@dataclass(frozen=True)
class Judged:
    """One marked segment: what became of it, why, how long after its end (s), and the faults it met."""

    marked: Marked
    verdict: Verdict
    detail: str
    latency_s: float | None
    met: Sequence[Strike]


@dataclass(frozen=True)
class Judgement:
    """All marked segments, and what was wrong with those that were found.

    What is told both as marked and as found is no violation: a mark that was held up comes after the action was found.
    """

    segments: Sequence[Judged]
    found: Collection[str]
    found_though_marked: int
    wrongly_found: Sequence[str]

    @property
    def violations(self) -> list[str]:
        """Everything that must not be, a line each."""
        return [
            *(
                f"{each.marked.segment_id} {each.verdict}: {each.detail}; met {faults(each.met)}"
                for each in self.segments
                if each.verdict not in ALLOWED
            ),
            *self.wrongly_found,
        ]


def judge(
    marked: Iterable[Marked], heard: Heard, undisturbed: Mapping[int, Event], strikes: Sequence[Strike]
) -> Judgement:
    """Judge what was heard; `undisturbed` is what is told of each action where nothing fails, by its number."""
    segments = [_judged(each, heard, undisturbed[each.action.number], strikes) for each in marked]
    told_first = {name: heard.events[name][0].content for name in sorted(heard.found) if heard.events[name]}
    told_of = {name: content for name, content in told_first.items() if isinstance(content, Event)}
    both = sum(any(_shared_s(event, each.marked) > 0 for each in segments) for event in told_of.values())
    return Judgement(segments, heard.found, both, [*_twice(heard), *_overlapping(told_of)])


def faults(strikes: Iterable[Strike]) -> str:
    """Name faults in words."""
    return ", ".join(str(strike.fault) for strike in strikes) or "no fault"


def _judged(marked: Marked, heard: Heard, expected: Event, strikes: Sequence[Strike]) -> Judged:
    answers = heard.events[marked.segment_id]
    if not answers:
        actions = heard.actions[marked.segment_id]
        detail = "an action, no event" if actions else "neither action nor event"
        return Judged(marked, "lost", detail, None, _met(marked, float("inf"), strikes))
    met = _met(marked, answers[0].arrived_s, strikes)
    latency_s = answers[0].arrived_s - marked.ended_s
    if heard.contents(marked.segment_id) > 1:
        contents = [*answers, *heard.actions[marked.segment_id]]
        return Judged(marked, "answered twice", "; ".join(told(each.content) for each in contents), latency_s, met)
    event = answers[0].content
    assert isinstance(event, Event)
    explaining = [strike for strike in met if _until_s(strike) + BACKLOG_S >= marked.started_s]
    verdict = _verdict(event, expected, met, explaining)
    compared = "" if verdict in ALLOWED else f", undisturbed {told(expected)}"
    return Judged(marked, verdict, told(event) + compared, latency_s, met)


def _verdict(event: Event, expected: Event, met: Sequence[Strike], explaining: Sequence[Strike]) -> Verdict:
    if not event.valid:
        return "rejected" if _is_true(event.reason or "", explaining) else "untrue reason"
    if event.action != expected.action:
        return "wrong"
    if _object(event) == _object(expected):
        return "right"
    unseen = event.object is None and event.why is not None
    return "right" if unseen and any(strike.fault.victim in OBJECTS for strike in met) else "wrong"


def _is_true(reason: str, explaining: Sequence[Strike]) -> bool:
    """Tell whether one of the faults makes a reason true."""
    causes = [cause for beginning, causes in REASONS.items() if reason.startswith(beginning) for cause in causes]
    return any(name in causes for strike in explaining for name in (strike.fault.victim, str(strike.fault)))


def _met(marked: Marked, answered_s: float, strikes: Sequence[Strike]) -> list[Strike]:
    """List the faults whose time, until all worked again, touches a segment's, from before it until its answer."""
    since_s = marked.started_s - LOOK_BACK_S
    return [strike for strike in strikes if strike.began_s <= answered_s and _until_s(strike) >= since_s]


def _until_s(strike: Strike) -> float:
    return float("inf") if strike.well_s is None else strike.well_s


def _object(event: Event) -> int | None:
    return None if event.object is None else event.object.id


def _twice(heard: Heard) -> list[str]:
    """Say which found segments were answered with different contents."""
    return [
        f"{name} found, and answered twice: "
        + "; ".join(told(answer.content) for answer in (*heard.events[name], *heard.actions[name]))
        for name in sorted(heard.found)
        if heard.contents(name) > 1
    ]


def _overlapping(told_of: Mapping[str, Event]) -> list[str]:
    """Say which found segments share time: one action was told as two."""
    return [
        f"{one} and {other} share {_shared_s(first, second):.1f} s: {told(first)}; {told(second)}"
        for (one, first), (other, second) in combinations(told_of.items(), 2)
        if _shared_s(first, second) > 0
    ]


def _shared_s(one: Event, other: Event | Marked) -> float:
    """Return how long two segments overlap (s), not positive where they do not."""
    return (min(one.end_ns, other.end_ns) - max(one.start_ns, other.start_ns)) / 1e9
