"""What the benchmark of killed classifiers prints of a segment that is answered otherwise."""

from benchmarks.many.scenes import Answer
from benchmarks.many.takeover import _difference

from scenes import action

KILLS = [(10.0, "north"), (24.0, "south")]
EXPECTED = Answer("push", 0.94, None, 60)


def test_what_is_answered_otherwise_is_printed_with_when_and_after_whose_end() -> None:
    printed = _difference("door", "s1", EXPECTED, [(26.5, action("push"))], KILLS)
    assert printed.startswith("- segment s1 of door: push 0.94 from 60 frames expected; push 0.94 from ")
    assert printed.endswith("from 100.00 to 102.00 s, 2.50 s after south was killed")


def test_an_answer_before_any_kill_and_none_at_all_are_printed() -> None:
    assert _difference("door", "s1", EXPECTED, [(9.0, action("push"))], KILLS).endswith("before any kill")
    assert _difference("door", "s1", EXPECTED, [], KILLS).endswith("expected; no answer")
