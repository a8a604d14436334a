"""The chaos run: what is drawn, when marks are put, and how answers are judged."""

from itertools import pairwise

import pytest
from benchmarks.chaos.faults import APART_S, Fault, Kind, drawn, possible
from benchmarks.chaos.hearing import Heard
from benchmarks.chaos.judge import Judgement, judge
from benchmarks.chaos.marking import Marked, Marker
from benchmarks.chaos.recovery import Signs, Strike, measure
from benchmarks.chaos.report import report
from benchmarks.chaos.scene import Planned, planned
from hypothesis import given
from hypothesis import strategies as st

from actum.messages import AUTO, Action, Event, Segment, Skeleton
from actum.node import SECOND_NS
from empty_messages import action, mark, skeleton, status
from events import event

pytestmark = pytest.mark.thorough

SESSION_NS = 1000 * SECOND_NS
LIFT = Planned(1, SECOND_NS, 3 * SECOND_NS, "lift", 2, marked=True)
PUSH = Planned(2, 5 * SECOND_NS, 7 * SECOND_NS, "push", 1, marked=False)
LIFTED = event("1", "", action="lift")
MARKED = Marked("m1-001", LIFT, SESSION_NS + LIFT.start_ns, SESSION_NS + LIFT.end_ns, started_s=101.0, ended_s=103.0)


def seen(since_start_s: float, session_ns: int = SESSION_NS) -> Skeleton:
    return skeleton(session_ns + round(since_start_s * SECOND_NS), session_id=f"simulator-{session_ns}")


def answer(**fields: object) -> Event:
    return LIFTED.model_copy(update={"segment_id": "m1-001", **fields})


def strike(victim: str, kind: Kind, began_s: float = 100.0, over_s: float = 102.0, well_s: float = 102.5) -> Strike:
    return Strike(Fault(victim, kind, 0.0), began_s, over_s, well_s)


def judged(*heard: Event | Action | Segment, strikes: tuple[Strike, ...] = ()) -> Judgement:
    listened = Heard()
    for number, message in enumerate(heard):
        listened.hear(message, 104.0 + number)
    return judge([MARKED], listened, {1: LIFTED}, strikes)


def verdict(*heard: Event | Action | Segment, strikes: tuple[Strike, ...] = ()) -> str:
    return judged(*heard, strikes=strikes).segments[0].verdict


@given(seed=st.integers(0, 1000), count=st.integers(1, 70), span_s=st.floats(1.0, 1000.0))
def test_faults_begin_one_after_the_other_and_each_possible_one_before_any_again(
    seed: int, count: int, span_s: float
) -> None:
    faults = drawn(seed, count, span_s)
    assert faults == drawn(seed, count, span_s)
    assert all(later.at_s - earlier.at_s >= APART_S for earlier, later in pairwise(faults))
    times = [sum((fault.victim, fault.kind) == each for fault in faults) for each in possible()]
    assert len(faults) == count and max(times) - min(times) <= 1


def test_only_the_faults_that_are_named_are_drawn() -> None:
    assert {(fault.victim, fault.kind) for fault in drawn(1, 5, 60.0, "link")} == {("link", "cut"), ("link", "silent")}
    with pytest.raises(ValueError, match="no fault is called 'router eaten'"):
        drawn(1, 5, 60.0, "router eaten")


def test_the_plan_is_what_the_scene_shows() -> None:
    actions = planned(3, 25)
    assert [each.number for each in actions] == [*range(1, 26)]
    assert all(one.start_ns < one.end_ns < next_one.start_ns for one, next_one in pairwise(actions))
    assert [sum(each.marked for each in actions[first : first + 5]) for first in range(0, 25, 5)] == [3] * 5
    assert actions == planned(3, 25)


def test_marks_are_put_on_time_though_nothing_is_heard_any_more() -> None:
    marker = Marker([LIFT, PUSH])
    marker.hear(seen(0.5), now_s=100.5)
    assert marker.due(100.9, "kinect0") == []
    starts, ends = marker.due(101.1, "kinect0"), marker.due(103.1, "kinect0")
    assert [(m.kind, m.stamp_ns) for m in (*starts, *ends)] == [
        ("start", SESSION_NS + LIFT.start_ns),
        ("end", SESSION_NS + LIFT.end_ns),
    ]
    assert marker.due(110.0, "kinect0") == [] and marker.due(110.0, "kinect0") == []
    assert marker.played == 2 and [*marker.marked] == ["m1-001"]


def test_a_session_that_begins_anew_is_marked_from_its_beginning_and_what_was_open_is_ended() -> None:
    marker = Marker([LIFT, PUSH])
    marker.hear(seen(0.0), now_s=100.0)
    marker.due(101.5, "kinect0")
    marker.hear(seen(0.0, 2 * SESSION_NS), now_s=102.0)
    assert [(m.kind, m.segment_id) for m in marker.due(103.0, "kinect0")] == [("start", "m2-001"), ("end", "m1-001")]


def test_what_goes_by_before_the_run_is_not_marked() -> None:
    marker = Marker([LIFT, PUSH])
    marker.hear(seen(0.0), now_s=100.0)
    assert marker.due(101.5, "kinect0", starting=False) == []
    assert marker.due(104.0, "kinect0") == [] and marker.played == 0


def test_the_answer_of_an_undisturbed_run_is_right_once_or_repeated() -> None:
    assert verdict(answer()) == verdict(answer(seq=1), answer(seq=2)) == "right"
    assert not judged(answer()).violations


def test_another_action_or_object_is_wrong() -> None:
    assert verdict(answer(action="push")) == "wrong"
    assert verdict(answer(object=None, why="no object seen")) == "wrong"


def test_without_the_tracker_the_object_may_be_unknown() -> None:
    unseen = answer(object=None, why="no object seen")
    assert verdict(unseen, strikes=(strike("marker_tracker", "paused"),)) == "right"
    assert verdict(unseen, strikes=(strike("som_classifier", "paused"),)) == "wrong"


def test_a_segment_without_an_event_is_lost() -> None:
    assert verdict() == verdict(action(1, 2, "m1-001")) == "lost"


def test_two_contents_are_one_too_many_also_of_actions() -> None:
    assert verdict(answer(), answer(confidence=0.5)) == "answered twice"
    twice = action(1, 2, "m1-001"), action(1, 3, "m1-001")
    assert verdict(answer(), *twice) == "answered twice"


def test_a_rejection_is_true_where_a_fault_explains_it() -> None:
    lost = answer(valid=False, reason="frames lost: none came for 2.0 s of the segment")
    assert verdict(lost) == "untrue reason"
    assert verdict(lost, strikes=(strike("marker_tracker", "killed"),)) == "untrue reason"
    assert verdict(lost, strikes=(strike("pose_preprocessor", "killed"),)) == "rejected"
    long_before = strike("pose_preprocessor", "killed", 95.0, 95.0, 97.0)
    assert verdict(lost, strikes=(long_before,)) == "untrue reason"


def test_only_a_scene_that_died_began_anew() -> None:
    anew = answer(valid=False, reason="the source started anew")
    assert verdict(anew, strikes=(strike("sensor_gateway", "paused"),)) == "untrue reason"
    assert verdict(anew, strikes=(strike("sensor_gateway", "killed"),)) == "rejected"


def test_that_a_mark_was_missing_is_never_true() -> None:
    missing = answer(valid=False, reason="end without start")
    assert verdict(missing, strikes=(strike("compute_router", "cut"),)) == "untrue reason"


def test_what_was_found_is_told_once_and_not_as_two_actions() -> None:
    found = [mark("start", 1, name, origin=AUTO) for name in ("auto-1", "auto-2")]
    told = [event(name, "", action="lift") for name in ("auto-1", "auto-2")]
    apart = told[1].model_copy(update={"start_ns": 5, "end_ns": 9})
    assert not judged(answer(), *found, told[0], apart).violations
    assert "auto-1 found, and answered twice" in str(
        judged(answer(), *found, told[0], told[0].model_copy(update={"missed": 1})).violations
    )
    assert "auto-1 and auto-2 share" in str(judged(answer(), *found, *told).violations)


def test_what_was_marked_and_found_is_counted() -> None:
    found = mark("start", 1, "auto-1", origin=AUTO)
    apart = event("auto-1", "", action="lift")
    same = apart.model_copy(update={"start_ns": MARKED.start_ns + 1, "end_ns": MARKED.end_ns})
    assert judged(answer(), found, apart).found_though_marked == 0
    assert judged(answer(), found, same).found_though_marked == 1


def test_all_is_well_once_everybody_behind_the_victim_works_on_what_is_new() -> None:
    signs, struck = Signs(), strike("som_classifier", "paused", 1.0, 6.0)
    for at_s, stamp_s in ((5.5, 5.5), (6.5, 5.0), (7.0, 6.9), (8.0, 8.0)):
        clock_ns = round(at_s * SECOND_NS)
        said = status().model_copy(update={"stamp_ns": round(stamp_s * SECOND_NS)})
        signs.hear(said, at_s, clock_ns)
    measure([struck], signs)
    assert struck.recovery_s == pytest.approx(1.0)


def test_what_never_works_again_is_told() -> None:
    struck = strike("sensor_gateway", "killed")
    measure([struck], Signs())
    assert struck.recovery_s is None
    lines = [*report(judged(answer(), strikes=(struck,)), [struck], Heard())]
    assert [line.split()[-1] for line in lines if line.startswith(("sensor_gateway", "link"))] == ["1", "0"]


def test_the_report_names_each_violation() -> None:
    judgement = judged(strikes=(strike("action_fusion", "killed"),))
    assert "violation: m1-001 lost: neither action nor event; met action_fusion killed" in [
        *report(judgement, [strike("action_fusion", "killed")], Heard())
    ]
