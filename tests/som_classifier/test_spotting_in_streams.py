"""A trained model finds actions in streams: the same at whatever pace, a true answer or none where frames are lost."""

import gc
import random
from collections import Counter
from collections.abc import Iterable, Sequence
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.messages import Action, Message, Posture, Segment
from actum.node import SECOND_NS, Tick
from actum.stamps import RESTART_AFTER
from people import FRAME_NS
from som_classifier.kinematics import GAP_NS
from som_classifier.node import POLL_TICKS, SomClassifier
from spotters import Box
from unmarked import Scene, bounds_ns, postures, scene, spotting_model
from wire import without_seq

FIRST_NS = 100 * SECOND_NS
PEOPLE = 3
Bounds = tuple[int, int, str]


@cache
def acting(agent: int = 1) -> Scene:
    """One of three people, who act each in their own order and at their own height."""
    order = [("lift", "push", "swing"), ("push", "swing", "lift"), ("swing", "lift", "push")][agent - 1]
    return scene(order, seed=6 + agent, height=0.9 + 0.1 * agent)


@cache
def stream(agent: int = 1, session: str = "test") -> tuple[Posture, ...]:
    named = {"agent": agent, "agents": [agent]}
    return tuple(p.model_copy(update=named) for p in postures(acting(agent).skeletons(FIRST_NS, session)))


def put_by(node: SomClassifier, messages: Iterable[Message | Tick]) -> list[Message]:
    return [answer for message in messages for answer in node.handle(message)]


@cache
def with_each_posture(agent: int) -> tuple[list[Message], ...]:
    """What a node puts that sees nobody else."""
    node = SomClassifier(spotting_model())
    return tuple([*node.handle(posture)] for posture in stream(agent))


def alone(agent: int, length: int | None = None) -> list[Message]:
    return [message for put in with_each_posture(agent)[:length] for message in put]


def found(put: Iterable[Message]) -> list[Bounds]:
    return [(m.start_ns, m.end_ns or 0, str(m.action)) for m in put if isinstance(m, Action) and m.final]


def answers(put: Iterable[Message]) -> list[tuple[object, ...]]:
    """What final actions say but for their names."""
    return [
        (m.start_ns, m.end_ns, m.action, m.confidence, m.familiarity, m.frames)
        for m in put
        if isinstance(m, Action) and m.final
    ]


def overlap(a: Bounds, b: Bounds) -> float:
    return max(min(a[1], b[1]) - max(a[0], b[0]), 0) / (max(a[1], b[1]) - min(a[0], b[0]))


def assert_true(said: Sequence[Bounds], postures_seen: Sequence[Posture]) -> None:
    """Bounds are stamps of frames that came, in order, and no segment holds a gap of more than half a second."""
    stamps_ns = np.array([p.stamp_ns for p in postures_seen if p.valid])
    for start_ns, end_ns, _ in said:
        assert start_ns in stamps_ns and end_ns in stamps_ns
        within = stamps_ns[(stamps_ns >= start_ns) & (stamps_ns <= end_ns)]
        assert np.diff(within).max() <= GAP_NS
    assert all(a[1] < b[0] for a, b in pairwise(said))


@pytest.mark.parametrize("agent", range(1, PEOPLE + 1))
def test_each_action_is_found_once_under_its_name_and_nothing_else(agent: int) -> None:
    truths = bounds_ns(acting(agent).acts, FIRST_NS)
    said = found(alone(agent))
    assert [each[2] for each in said] == [each[2] for each in truths]
    assert all(overlap(a, b) > 0.5 for a, b in zip(said, truths, strict=True))


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    delays_s=st.lists(st.floats(0.0, 2.0), min_size=PEOPLE, max_size=PEOPLE),
    until=st.floats(0.0, 1.0),
)
def test_whoever_else_is_there_whatever_the_delays_a_prefix_says_what_the_whole_says(
    seed: int, delays_s: Sequence[float], until: float
) -> None:
    rng = random.Random(seed)
    arriving = [
        (p.stamp_ns + round(delays_s[p.agent - 1] * SECOND_NS) + rng.randrange(FRAME_NS), p)
        for agent in range(1, PEOPLE + 1)
        for p in stream(agent)
    ]
    came = sorted(arriving, key=lambda each: each[0])[: round(until * len(arriving))]
    node, put = SomClassifier(spotting_model()), []
    for arrival_ns, posture in came:
        put += [*node.handle(posture)]
        if rng.random() < 0.1:
            put += [*node.handle(Tick(arrival_ns))]
    for agent in range(1, PEOPLE + 1):
        own = [m for m in put if getattr(m, "agent", None) == agent]
        assert without_seq(own) == without_seq(alone(agent, sum(p.agent == agent for _, p in came)))


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), lost=st.floats(0.0, 0.9))
def test_of_a_stream_that_loses_frames_only_what_came_is_told(seed: int, lost: float) -> None:
    rng = random.Random(seed)
    came = [p for p in stream() if rng.random() >= lost]
    node = SomClassifier(spotting_model())
    put = put_by(node, came)
    assert_true(found(put), came)
    assert not node.counters.rejects
    counts = node.counters.counts
    assert counts["found"] == counts["told"] + counts["unanswerable"] + counts["unknown"]


@pytest.mark.parametrize("seed", range(3))
def test_a_tenth_of_the_frames_lost_loses_no_action(seed: int) -> None:
    rng = random.Random(seed)
    said = found(put_by(SomClassifier(spotting_model()), [p for p in stream() if rng.random() >= 0.1]))
    assert [each[2] for each in said] == [each[2] for each in found(alone(1))]
    assert all(overlap(a, b) > 0.7 for a, b in zip(said, found(alone(1)), strict=True))


@pytest.mark.parametrize("gone_s", [0.6, 5.0, 100.0])
@pytest.mark.parametrize("part", [0.2, 0.5, 0.8])
def test_who_vanishes_in_the_middle_of_an_action_and_comes_back_is_searched_as_if_new(
    part: float, gone_s: float
) -> None:
    """The second of three actions is broken off. After 100 s the stream itself has been forgotten."""
    act = acting().acts[1]
    at = round(act.first + part * (act.last - act.first))
    before, after = stream()[:at], [_later(p, gone_s) for p in stream()[at:]]
    node = SomClassifier(spotting_model())
    said = put_by(node, before)
    later = put_by(node, after)
    assert_true(found([*said, *later]), [*before, *after])
    assert answers(later) == answers(put_by(SomClassifier(spotting_model()), after))
    assert [label for *_, label in found(said)] == ["lift"]
    assert "swing" in [label for *_, label in found(later)]
    assert not any(isinstance(m, Action) and m.start_ns < after[0].stamp_ns for m in later)


def _later(posture: Posture, seconds: float) -> Posture:
    return posture.model_copy(update={"stamp_ns": posture.stamp_ns + round(seconds * SECOND_NS), "seq": None})


@pytest.mark.parametrize(("frames", "survives"), [(3, True), (12, True), (20, False)])
def test_frames_without_a_posture_in_an_action_are_borne_for_half_a_second(frames: int, survives: bool) -> None:
    act = acting().acts[1]
    first = (act.first + act.last - frames) // 2
    lost = {"valid": False, "reason": "lost", "joints": None, "upright": None, "motion": None}
    seen = [p.model_copy(update=lost) if first <= i < first + frames else p for i, p in enumerate(stream())]
    put = put_by(SomClassifier(spotting_model()), seen)
    assert_true(found(put), seen)
    nothing = {p.stamp_ns for p in seen if not p.valid}
    assert not any(isinstance(m, Action) and m.stamp_ns in nothing and not m.final for m in put)
    whole = [each for each in found(put) if overlap(each, found(alone(1))[1]) > 0.7]
    assert bool(whole) is survives


@pytest.mark.parametrize("at", [20, 60, 100])
def test_a_source_that_starts_anew_from_the_same_stamp_is_searched_as_the_first_time(at: int) -> None:
    node = SomClassifier(spotting_model())
    put_before = put_by(node, stream()[:at])
    put = put_by(node, stream(session="anew"))
    assert answers(put) == answers(alone(1))
    names = [{m.segment_id for m in messages if isinstance(m, Action)} for messages in (put_before, put)]
    assert not names[0] & names[1]


@pytest.mark.parametrize("at", [20, 60, 100])
def test_after_a_clock_that_steps_back_the_search_begins_anew(at: int) -> None:
    """With the frame that shows that it has."""
    back = [_later(p, -90.0) for p in stream()]
    node = SomClassifier(spotting_model())
    put_by(node, stream()[:at])
    put = put_by(node, back)
    assert answers(put) == answers(put_by(SomClassifier(spotting_model()), back[RESTART_AFTER - 1 :]))
    assert len(answers(put)) == len(acting().acts)


@pytest.mark.parametrize("act", range(3))
def test_another_model_in_the_middle_of_an_action_knows_nothing_of_what_was_before(act: int) -> None:
    box = Box()
    node = SomClassifier(spotting_model(), box)
    of = acting().acts[act]
    at = (of.first + of.last) // 2
    before = put_by(node, stream()[:at])
    box.model = spotting_model()
    after = put_by(node, [*[Tick(i) for i in range(POLL_TICKS)], *stream()[at:]])
    assert all(m.start_ns >= stream()[at].stamp_ns for m in after if isinstance(m, Action))
    assert_true(found([*before, *after]), stream())
    expected = [each[2] for n, each in enumerate(found(alone(1))) if n != act]
    assert [each[2] for each in found([*before, *after]) if each[2] != of.action] == expected
    ids = [m.segment_id for m in [*before, *after] if isinstance(m, Action) and m.final]
    assert len(ids) == len(set(ids))


@pytest.mark.long
def test_an_hour_keeps_no_more_than_its_first_minutes() -> None:
    """Of every kind of object: frames, candidates, names, marks. Three frames a second are enough to find actions."""
    node, of, rate_hz = SomClassifier(spotting_model()), stream()[::10], 3
    kept: list[Counter[str]] = []
    marks = 0
    for i in range(3600 * rate_hz):
        posture = of[i % len(of)].model_copy(update={"stamp_ns": FIRST_NS + i * SECOND_NS // rate_hz, "seq": None})
        marks += sum(isinstance(m, Segment) for m in node.handle(posture))
        if i in (300 * rate_hz, 3600 * rate_hz - 1):
            kept.append(Counter(type(each).__name__ for each in gc.get_objects()))
    assert marks > 500
    assert {name: n - kept[0][name] for name, n in kept[1].items() if n - kept[0][name] > 30} == {}
