"""Who is who from image to image: each person found gets the number of the one expected nearest to that place."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum import filters
from actum.node import SECOND_NS
from sensor_gateway.camera.landmarks import Array

FORGET_NS = 3 * SECOND_NS // 2
"""How long somebody unseen is expected back."""

COAST_NS = SECOND_NS
"""How long somebody unseen is expected to walk on."""

REACH_M = 0.5
"""How far from where they are expected somebody is still the same person …"""

REACH_MPS = 0.7
"""… and how fast that grows while they are not seen."""

DEPTH_SHARE = 0.3
"""What a metre along the line of sight counts, where one image tells little of distance."""

NEWCOMER_COST = 100.0
AMBIGUOUS_COST = 0.15
"""By how much somebody must be the more likely one, where another is not to be seen."""

MEASURED_STD_M = np.array([0.04, 0.04, 0.2])
"""How exactly one image tells where somebody is: x, y, z."""

ACCELERATION_STD_MPS2 = np.array([2.0, 2.0, 0.5])
WALKING_STD_MPS = 0.8


@dataclass(frozen=True)
class _Track:
    """One person's position and velocity in the camera frame, filtered up to a stamp."""

    agent: int
    stamp_ns: int
    motion: filters.MotionEstimate

    def expected_m(self, stamp_ns: int) -> Array:
        coasting_s = min(stamp_ns - self.stamp_ns, COAST_NS) / SECOND_NS
        return self.motion.position_m + self.motion.velocity_mps * coasting_s

    def reach_m(self, stamp_ns: int) -> float:
        return REACH_M + REACH_MPS * (stamp_ns - self.stamp_ns) / SECOND_NS

    def seen_at(self, stamp_ns: int, position_m: Array) -> "_Track":
        ahead = self.expected_at(stamp_ns)
        motion, _ = filters.updated(ahead.motion, position_m, np.diag(MEASURED_STD_M**2))
        return replace(ahead, motion=motion)

    def expected_at(self, stamp_ns: int) -> "_Track":
        """Predict to a stamp; the position goes on no longer than `COAST_NS`, its uncertainty grows all the time."""
        interval_s = (stamp_ns - self.stamp_ns) / SECOND_NS
        ahead = filters.predicted(self.motion, interval_s, ACCELERATION_STD_MPS2)
        state = np.concatenate([self.expected_m(stamp_ns), self.motion.velocity_mps])
        return replace(self, stamp_ns=stamp_ns, motion=replace(ahead, state=state))


class People:
    """Numbers people, from 1, in the order in which they first appear; nobody gets a number that another had."""

    def __init__(self) -> None:
        self._tracks: list[_Track] = []
        self._next = 1

    def step(self, stamp_ns: int, positions_m: Sequence[Array]) -> list[int]:
        """Return the agent of each position (3,; m, camera frame) found in one image; stamps rise."""
        known = [track for track in self._tracks if 0 < stamp_ns - track.stamp_ns <= FORGET_NS]
        costs = [[_cost(track, stamp_ns, position) for track in known] for position in positions_m]
        chosen = _assigned(costs)
        unseen = [i for i in range(len(known)) if i not in chosen]
        seen = [
            self._seen(known, i, row, unseen, stamp_ns, position)
            for i, row, position in zip(chosen, costs, positions_m, strict=True)
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
        """Follow one person; who may be another one, hidden behind or before them, goes on as expected."""
        if i is None:
            return self._new(stamp_ns, position_m)
        if any(costs[other] < costs[i] + AMBIGUOUS_COST for other in unseen):
            return known[i].expected_at(stamp_ns)
        return known[i].seen_at(stamp_ns, position_m)

    @property
    def expected(self) -> frozenset[int]:
        """Those who are seen or expected back."""
        return frozenset(track.agent for track in self._tracks)

    def _new(self, stamp_ns: int, position_m: Array) -> _Track:
        agent, self._next = self._next, self._next + 1
        motion = filters.initial(position_m, np.diag(MEASURED_STD_M**2), WALKING_STD_MPS)
        return _Track(agent, stamp_ns, motion)


def _cost(track: _Track, stamp_ns: int, position_m: Array) -> float:
    """Return how far a position is from where somebody is expected, squared, in reaches; too far is beyond price."""
    apart_m = _apart_m(track.expected_m(stamp_ns), position_m)
    return (apart_m / REACH_M) ** 2 if apart_m < track.reach_m(stamp_ns) else float("inf")


def _apart_m(expected_m: Array, position_m: Array) -> float:
    """Return a distance in which the part along the line of sight counts less."""
    sight = position_m / max(float(np.linalg.norm(position_m)), 1e-9)
    apart = position_m - expected_m
    along = float(apart @ sight)
    across = apart - along * sight
    return float(np.hypot(np.linalg.norm(across), DEPTH_SHARE * along))


def _assigned(costs: Sequence[Sequence[float]]) -> list[int | None]:
    """Choose for each row a column of its own, or none, which costs more than all else, with the smallest sum."""
    return list(min(_choices(costs, frozenset()), key=lambda choice: choice[0])[1])


def _choices(costs: Sequence[Sequence[float]], taken: frozenset[int]) -> Iterator[tuple[float, tuple[int | None, ...]]]:
    if not costs:
        yield 0.0, ()
        return
    first, *rest = costs
    options: list[tuple[float, int | None]] = [(NEWCOMER_COST, None)]
    options += [(cost, i) for i, cost in enumerate(first) if cost < NEWCOMER_COST and i not in taken]
    for cost, i in options:
        for total, others in _choices(rest, taken if i is None else taken | {i}):
            yield cost + total, (i, *others)
