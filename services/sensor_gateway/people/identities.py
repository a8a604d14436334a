"""Multi-person tracking: assigns each detection the number of the track that it continues."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Array
from actum.filters import MotionEstimate
from actum.node import SECOND_NS

FORGET_NS = 3 * SECOND_NS // 2
"""Time without detection after which a track is dropped."""

COAST_NS = SECOND_NS
"""Time without detection for which a track is predicted at constant velocity; then it stands still."""

REACH_M = 0.5
"""Gate: largest distance (m) of a detection from a track's predicted position."""

REACH_MPS = 0.7
"""Growth of the gate (m/s) with the time since the track's last detection."""

DEPTH_SHARE = 0.3
"""Weight of a distance along the ray relative to one across it: one image determines depth poorly."""

NEWCOMER_COST = 100.0
"""Cost of a new track, in squared `REACH_M`: more than any assignment to an existing track."""

AMBIGUOUS_COST = 0.15
"""Least difference of cost between a detection's track and an undetected one, in squared `REACH_M`."""

MEASURED_STD_M = np.array([0.04, 0.04, 0.2])
"""Standard deviation (3,; x, y, z) of a position measured in one image."""

ACCELERATION_STD_MPS2 = np.array([2.0, 2.0, 0.5])
"""Process noise (3,; x, y, z): small along z, where the measurement says little."""

WALKING_STD_MPS = 0.8
"""Standard deviation of a new track's velocity: the person stands or walks."""


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
        """Predict the track at a stamp: the position moves for `COAST_NS` at most, the uncertainty always grows."""
        ahead = self.motion.predicted((stamp_ns - self.stamp_ns) / SECOND_NS, ACCELERATION_STD_MPS2)
        state = np.concatenate([self.predicted_m(stamp_ns), self.motion.velocity_mps])
        return replace(self, stamp_ns=stamp_ns, motion=replace(ahead, state=state))


class Identities:
    """Numbers people from 1 in the order in which they first appear; numbers are never used again."""

    def __init__(self) -> None:
        self._tracks: list[_Track] = []
        self._next = 1

    def step(self, stamp_ns: int, positions_m: Sequence[Array]) -> list[int]:
        """Return the number of the person at each position (3,; m, camera frame) detected in one image; stamps rise."""
        known = [track for track in self._tracks if 0 < stamp_ns - track.stamp_ns <= FORGET_NS]
        costs = [[_cost(track, stamp_ns, position) for track in known] for position in positions_m]
        assigned = list(min(_assignments(costs, frozenset()), key=lambda choice: choice[0])[1])
        undetected = [i for i in range(len(known)) if i not in assigned]
        detected = [
            self._continued(known, i, row, undetected, stamp_ns, position)
            for i, row, position in zip(assigned, costs, positions_m, strict=True)
        ]
        self._tracks = detected + [known[i] for i in undetected]
        return [track.agent for track in detected]

    def _continued(
        self,
        known: Sequence[_Track],
        i: int | None,
        costs: Sequence[float],
        undetected: Sequence[int],
        stamp_ns: int,
        position_m: Array,
    ) -> _Track:
        """Continue a person's track, only by prediction if the detection may belong to an undetected track as well."""
        if i is None:
            agent, self._next = self._next, self._next + 1
            motion = MotionEstimate.initial(position_m, np.diag(MEASURED_STD_M**2), WALKING_STD_MPS)
            return _Track(agent, stamp_ns, motion)
        if any(costs[other] < costs[i] + AMBIGUOUS_COST for other in undetected):
            return known[i].predicted(stamp_ns)
        return known[i].updated(stamp_ns, position_m)

    @property
    def expected(self) -> frozenset[int]:
        """The numbers of the people whose tracks are kept, detected or not."""
        return frozenset(track.agent for track in self._tracks)


def _cost(track: _Track, stamp_ns: int, position_m: Array) -> float:
    """Return the squared distance of a position from the prediction, in squared `REACH_M`; infinite beyond the gate."""
    ray = position_m / max(float(np.linalg.norm(position_m)), 1e-9)
    offset = position_m - track.predicted_m(stamp_ns)
    along = float(offset @ ray)
    across = offset - along * ray
    distance_m = float(np.hypot(np.linalg.norm(across), DEPTH_SHARE * along))
    return (distance_m / REACH_M) ** 2 if distance_m < track.reach_m(stamp_ns) else float("inf")


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
