"""The marks of what was cut, and what is doubted of each."""

import numpy as np

from actum.node import SECOND_NS
from actum_examples.cutting.courses import Course
from actum_examples.cutting.doubts import Doubt
from actum_examples.cutting.repetitions import Cuts, Repetition
from actum_examples.marking import OF_THE_TAKE, marking_of


def test_each_doubt_is_filed_under_the_segment_that_it_is_about() -> None:
    course = Course(1, 0, np.zeros((300, 15, 3)), np.zeros(300), np.zeros(15), 2.0)
    repetitions = tuple(Repetition(k * SECOND_NS, (k + 1) * SECOND_NS, 0.9) for k in range(3))
    doubted = (Doubt("too many", None), Doubt("long", 1), Doubt("unlike", 3), Doubt("short", 3))
    marking = marking_of(Cuts(course, np.zeros(300), repetitions, 0.9, doubted), 3, "lift", "kinect0")
    assert marking.marks is not None
    first, _, last = (mark.segment_id for mark in marking.marks if mark.kind == "start")
    assert marking.doubts == {OF_THE_TAKE: ["too many"], first: ["long"], last: ["unlike", "short"]}
