"""Keeps people's identities from image to image: a detection gets the number of the track that it continues."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Array
from actum.filters import MotionEstimate
from actum.node import SECOND_NS

FORGET_NS = 3 * SECOND_NS // 2
"""How long somebody unseen keeps their track."""

COAST_NS = SECOND_NS
"""How long somebody unseen is predicted to walk on at the same velocity."""

REACH_M = 0.5
"""How far (m) from the predicted position somebody is still the same person …"""

REACH_MPS = 0.7
"""… and how fast that grows (m/s) while they are not seen."""

DEPTH_SHARE = 0.3
"""What a metre along the ray counts against one across it: one image tells little of distance."""

NEWCOMER_COST = 100.0
"""Of a new track, in squared reaches: more than any assignment to the tracks there are."""

AMBIGUOUS_COST = 0.15
"""How much less a detection must cost with its own track than with one that is not seen now, in squared reaches."""

MEASURED_STD_M = np.array([0.04, 0.04, 0.2])
"""Standard deviation (3,; x, y, z) of a position measured in one image."""

ACCELERATION_STD_MPS2 = np.array([2.0, 2.0, 0.5])
"""Process noise (3,; x, y, z): small along z, where the measurement says little."""

WALKING_STD_MPS = 0.8
"""Of a new track's velocity: somebody stands there or walks in."""


@dataclass(frozen=True)
class _Track:
    """One person's track: the motion in the camera frame, filtered up to a stamp."""

    agent: int
    stamp_ns: int
    motion: MotionEstimate

    def predicted_m(self, stamp_ns: int) -> Array:
        coasting_s = min(stamp_ns - self.stamp_ns, COAST_NS) / SECOND_NS
        return self.motion.position_m + self.motion.velocity_mps * coasting_s

    def reach_m(self, stamp_ns: int) -> float:
        return REACH_M + REACH_MPS * (stamp_ns - self.stamp_ns) / SECOND_NS

    def updated(self, stamp_ns: int, position_m: Array) -> "_Track":
        ahead = self.predicted(stamp_ns)
        motion, _ = ahead.motion.updated(position_m, np.diag(MEASURED_STD_M**2))
        return replace(ahead, motion=motion)

    def predicted(self, stamp_ns: int) -> "_Track":
        """Predict up to a stamp: the position coasts for `COAST_NS` at most, its uncertainty grows all the time."""
        ahead = self.motion.predicted((stamp_ns - self.stamp_ns) / SECOND_NS, ACCELERATION_STD_MPS2)
        state = np.concatenate([self.predicted_m(stamp_ns), self.motion.velocity_mps])
        return replace(self, stamp_ns=stamp_ns, motion=replace(ahead, state=state))


class Identities:
    """Numbers people, from 1, in the order in which they first appear; nobody gets a number that another had."""

    def __init__(self) -> None:
        self._tracks: list[_Track] = []
        self._next = 1

    def step(self, stamp_ns: int, positions_m: Sequence[Array]) -> list[int]:
        """Return the number of the person at each position (3,; m, camera frame) found in one image; stamps rise."""
        known = [track for track in self._tracks if 0 < stamp_ns - track.stamp_ns <= FORGET_NS]
        costs = [[_cost(track, stamp_ns, position) for track in known] for position in positions_m]
        assigned = _assigned(costs)
        unseen = [i for i in range(len(known)) if i not in assigned]
        seen = [
            self._seen(known, i, row, unseen, stamp_ns, position)
            for i, row, position in zip(assigned, costs, positions_m, strict=True)
        ]
        self._tracks = seen + [known[i] for i in unseen]
        return [track.agent for track in seen]

    def _seen(
        self,
        known: Sequence[_Track],
        i: int | None,
        costs: Sequence[float],
        unseen: Sequence[int],
        stamp_ns: int,
        position_m: Array,
    ) -> _Track:
        """Continue one person's track; by prediction alone where the detection may be a hidden person's as well."""
        if i is None:
            return self._new(stamp_ns, position_m)
        if any(costs[other] < costs[i] + AMBIGUOUS_COST for other in unseen):
            return known[i].predicted(stamp_ns)
        return known[i].updated(stamp_ns, position_m)

    @property
    def expected(self) -> frozenset[int]:
        """The numbers of the people who are seen or expected back."""
        return frozenset(track.agent for track in self._tracks)

    def _new(self, stamp_ns: int, position_m: Array) -> _Track:
        agent, self._next = self._next, self._next + 1
        motion = MotionEstimate.initial(position_m, np.diag(MEASURED_STD_M**2), WALKING_STD_MPS)
        return _Track(agent, stamp_ns, motion)


def _cost(track: _Track, stamp_ns: int, position_m: Array) -> float:
    """Return the squared distance of a position from the predicted one, in squared reaches; infinite where too far."""
    apart_m = _apart_m(track.predicted_m(stamp_ns), position_m)
    return (apart_m / REACH_M) ** 2 if apart_m < track.reach_m(stamp_ns) else float("inf")


def _apart_m(expected_m: Array, position_m: Array) -> float:
    """Return a distance in which the part along the ray counts less."""
    ray = position_m / max(float(np.linalg.norm(position_m)), 1e-9)
    apart = position_m - expected_m
    along = float(apart @ ray)
    across = apart - along * ray
    return float(np.hypot(np.linalg.norm(across), DEPTH_SHARE * along))


def _assigned(costs: Sequence[Sequence[float]]) -> list[int | None]:
    """Assign each row a column of its own, or None at `NEWCOMER_COST`, so that the sum of the costs is smallest."""
    return list(min(_assignments(costs, frozenset()), key=lambda choice: choice[0])[1])


def _assignments(
    costs: Sequence[Sequence[float]], taken: frozenset[int]
) -> Iterator[tuple[float, tuple[int | None, ...]]]:
    if not costs:
        yield 0.0, ()
        return
    first, *rest = costs
    options: list[tuple[float, int | None]] = [(NEWCOMER_COST, None)]
    options += [(cost, i) for i, cost in enumerate(first) if cost < NEWCOMER_COST and i not in taken]
    for cost, i in options:
        for total, others in _assignments(rest, taken if i is None else taken | {i}):
            yield cost + total, (i, *others)
