"""Counts the repetitions of one action while they are done."""

from dataclasses import replace
from typing import Literal

import numpy as np

from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum_examples.cutting.courses import RATE_HZ, Course, PersonTracks
from actum_examples.cutting.doubts import Doubt, too_few
from actum_examples.cutting.repetitions import Cuts, cut, cut_so_far

COUNT_EVERY_S = 0.5
"""Shortest time between two counts: a repetition is noticed soon after its end."""
COUNT_SHARE = 0.05
"""Time between two counts as a share of the stream so far: counting takes longer the longer the stream is."""
LAST_REST_S = 3.0
"""Rest after which the last repetition is over."""
REST_RATIO = 2.0
"""That rest is also longer than any before, by this factor: a stop within each of them is no end."""
ONE_REST_S = 1.0
"""Rest after which a single movement counts as one repetition: there is no other to compare it with."""
NOW_S = 0.3
"""Time over which the activity of now is averaged."""
MOVING = 0.6
"""Activity above which a person moves: it is about 1 in the midst of a movement, and 0.4 in a noisy sensor's rest."""
NOBODY = "nobody was in view: stand where the camera sees your whole body"
STILL = "the movement was no larger than the noise of standing still: move further, or stand nearer to the camera"
UNLIKE = (
    "no two movements were alike, so the {} repetitions were not found: do the same movement each time, and stand "
    "still for a second or two before and after"
)
MUCH_LESS_ALIKE = 0.5
"""Ratio of the least likenesses below which the missing repetitions have only been parted from others."""


class RepetitionCounter:
    """Takes a person's skeletons, counts what is repeated in them, and cuts it out in the end.

    Attributes:
        asked: how many repetitions there are to be.
        first_ns: stamp of the first skeleton, None before it came.
        sensor: of the skeletons; empty before the first.
        so_far: the newest count; None before anybody moved.
    """

    def __init__(self, asked: int, agent: int | None = None) -> None:
        self.asked = asked
        self.first_ns: int | None = None
        self.sensor = ""
        self.so_far: Cuts | None = None
        self._agent = agent
        self._tracks = PersonTracks()
        self._next_count_ns = 0

    def receive(self, skeleton: Skeleton) -> bool:
        """Receive the next frame; return whether the repetitions were counted anew."""
        if self.first_ns is None or skeleton.stamp_ns < self.first_ns:
            self.first_ns = self._next_count_ns = skeleton.stamp_ns
        self.sensor = skeleton.sensor
        self._tracks.receive(skeleton)
        if skeleton.stamp_ns < self._next_count_ns:
            return False
        so_far_ns = skeleton.stamp_ns - self.first_ns
        self._next_count_ns = skeleton.stamp_ns + round(max(COUNT_EVERY_S * SECOND_NS, COUNT_SHARE * so_far_ns))
        self.so_far = cut_so_far(self._courses(), self.asked, self.first_ns)
        return True

    @property
    def count(self) -> int:
        """How many repetitions there are so far, at most as many as were asked for."""
        if self.so_far is None:
            return 0
        found = len(self.so_far.repetitions)
        return found if found != 1 or self.so_far.resting_s > ONE_REST_S else 0

    @property
    def finished(self) -> bool:
        """Whether the last repetition is followed by a long rest."""
        if self.so_far is None or self.count < self.asked:
            return False
        return self.so_far.resting_s > max(LAST_REST_S, REST_RATIO * self.so_far.longest_pause_s)

    @property
    def phase(self) -> Literal["waiting", "moving", "resting"]:
        """What the person does now; waiting before the first movement."""
        if self.so_far is None:
            return "waiting"
        if float(np.mean(self.so_far.activity[-round(NOW_S * RATE_HZ) :])) > MOVING:
            return "moving"
        return "resting" if self.count else "waiting"

    def cuts(self) -> Cuts | None:
        """Cut as many repetitions as were asked for out of all that came; None where nothing counts, see `why_none`.

        Where somebody ended it early they are fewer: as many as were counted, if these are much more alike.
        """
        courses = self._courses()
        all_asked = cut(courses, self.asked, self.first_ns or 0)
        self.so_far = cut_so_far(courses, self.asked, self.first_ns or 0)
        if all_asked is None or self.so_far is None:
            return None
        found, alike = len(all_asked.repetitions), len(self.so_far.repetitions)
        if found < self.asked and alike == 1:
            return None
        if not 1 < alike < self.asked or _least_likeness(all_asked) >= MUCH_LESS_ALIKE * _least_likeness(self.so_far):
            return all_asked
        return replace(self.so_far, doubted=(Doubt(too_few(alike, self.asked), None), *self.so_far.doubted))

    @property
    def why_none(self) -> str:
        """Why nothing counts where `cuts` returned None, and what to do."""
        if not self._courses():
            return NOBODY
        return STILL if self.so_far is None else UNLIKE.format(self.asked)

    def _courses(self) -> list[Course]:
        return [course for course in self._tracks.courses() if self._agent in (None, course.agent)]


def _least_likeness(cuts: Cuts) -> float:
    return min(repetition.likeness for repetition in cuts.repetitions)
