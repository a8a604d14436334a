"""The course of a recording's activity as a line of bars, with the numbers of what was cut beneath."""

import numpy as np
import pytest

from actum.node import SECOND_NS
from actum_command.segment_lines import BARS, COLUMNS, FULL, course_lines
from actum_examples.cutting.courses import RATE_HZ, Course
from actum_examples.cutting.repetitions import Cuts, Repetition

START_NS = 10**15


@pytest.mark.parametrize("per_column", [1, 3])
def test_the_number_of_each_cut_stands_beneath_its_bars(per_column: int) -> None:
    bounds = [(12, 30), (40, 41), (70, 100)]
    activity = np.zeros(COLUMNS * per_column)
    for first, after in bounds:
        activity[first * per_column : after * per_column] = FULL
    frame_ns = SECOND_NS * per_column / RATE_HZ
    cut = tuple(Repetition(*(START_NS + round(at * frame_ns) for at in each), 1.0) for each in bounds)
    course = Course(1, START_NS, np.zeros((len(activity), 15, 3)), activity, np.zeros(15), 2.0)
    bars, numbers = course_lines(Cuts(course, activity, cut, 1.0, ()))
    expected = [" "] * COLUMNS
    for number, (first, after) in enumerate(bounds, start=1):
        expected[first:after] = str(number) * (after - first)
    assert numbers == "".join(expected)
    assert bars == "".join(BARS[0] if each == " " else BARS[-1] for each in expected)


@pytest.mark.parametrize("step", range(len(BARS)))
def test_a_bar_is_as_high_as_the_activity(step: int) -> None:
    activity = np.full(5, FULL * step / (len(BARS) - 1))
    course = Course(1, START_NS, np.zeros((5, 15, 3)), activity, np.zeros(15), 2.0)
    assert course_lines(Cuts(course, activity, (), 1.0, ())) == (BARS[step] * 5, "")
