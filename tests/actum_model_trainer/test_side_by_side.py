"""Parts of a training run side by side, as many as are allowed, and give what they would one after the other."""

import threading

import numpy as np
import pytest

from actum_model_trainer.side_by_side import at_most, side_by_side
from actum_model_trainer.training import train_to_spot
from performers import TINY
from unmarked import spotting_model, taught


class Counted:
    """Counts how many parts run at the same time: each waits until all that may have begun."""

    def __init__(self, allowed: int) -> None:
        self.most = 0
        self._now = 0
        self._lock = threading.Lock()
        self._all = threading.Barrier(allowed)

    def __call__(self, item: int) -> int:
        with self._lock:
            self._now += 1
            self.most = max(self.most, self._now)
        self._all.wait(timeout=20)
        with self._lock:
            self._now -= 1
        return item * item


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_as_many_parts_run_at_the_same_time_as_are_allowed(jobs: int) -> None:
    counted = Counted(jobs)
    with at_most(jobs):
        assert side_by_side(counted, range(6)) == [0, 1, 4, 9, 16, 25]
    assert counted.most == jobs


def test_what_runs_within_a_part_adds_no_threads() -> None:
    with at_most(2):
        inner = side_by_side(lambda _: side_by_side(lambda _: threading.current_thread().name, range(3)), range(2))
    assert [len(set(names)) for names in inner] == [1, 1]


def test_the_limit_ends_with_its_block() -> None:
    with at_most(5):
        with at_most(1):
            pass
        counted = Counted(5)
        side_by_side(counted, range(5))
    assert counted.most == 5


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_any_number_makes_the_same_model_to_the_bit(jobs: int) -> None:
    with at_most(jobs):
        model = train_to_spot(taught().usable, taught().streams, TINY)
    assert model.id == spotting_model().id
    for name, array in model.arrays.items():
        assert np.array_equal(array, spotting_model().arrays[name]), name
