"""Where a person's arms and the objects have been lately: all that is known at an instant, and nothing later."""

from bisect import bisect_right
from collections import deque

import numpy as np
from numpy.typing import NDArray

from action_fusion.intake.columns import Columns
from action_fusion.intake.stream_samples import HANDS, Body, ObjectsSample
from actum.arrays import Array
from actum.messages import Hand
from actum.node import SECOND_NS
from actum.skeletons import INDEX

SIDES: tuple[Hand, Hand] = ("right", "left")
"""The hands, in the order of `stream_samples.HANDS`."""
ARMS = [*HANDS, *(INDEX[f"{side}_{joint}"] for joint in ("elbow", "shoulder") for side in SIDES)]
"""The joints that are looked at: hands, elbows and shoulders."""
LATEST_ROWS = 256
"""Postures, and places of an object, that are kept at the most: two seconds at 120 a second."""
LONGEST_GAP_NS = SECOND_NS // 2
"""After a longer gap in the postures a path begins anew (ns)."""
KNOWN_NS = 10 * SECOND_NS
"""How long (ns) after it was seen last an object counts as where it was: the hand that reaches for it covers it."""
OBJECTS_LATE_NS = SECOND_NS // 10
"""How much older (ns) the objects are that a posture is compared with. Trackers are up to this late; so what is said
does not depend on which message came first."""
TRACK_NS = 2 * SECOND_NS
"""How long (ns) an object's places are kept."""


def arms_of(body: Body) -> Array:
    """Return a posture's joints in the camera frame, (joints, 3) in the order of `ARMS`."""
    joints_m: Array = (body.joints_m[ARMS] - body.ego_from_camera[:3, 3]) @ body.ego_from_camera[:3, :3]
    return joints_m


class RecentArms:
    """A person's hands, elbows and shoulders in the camera frame over the last two seconds."""

    def __init__(self) -> None:
        self._stamps, self._joints = Columns(np.int64), Columns(np.float64, len(ARMS), 3)
        self._count = 0

    @property
    def newest_ns(self) -> int:
        """Stamp of the newest posture, -1 where there is none."""
        return int(self._stamps.newest(1)[0]) if self._count else -1

    def append(self, stamp_ns: int, joints_m: Array) -> None:
        """Add the joints of the next posture, (joints, 3) in the order of `ARMS`; NaN where one is unknown."""
        if self._count and stamp_ns - self.newest_ns > LONGEST_GAP_NS:
            self._count = 0
        self._count = min(self._count + 1, LATEST_ROWS)
        self._stamps.append(stamp_ns, self._count)
        self._joints.append(joints_m, self._count)

    def at(self, delays_ns: NDArray[np.int64]) -> Array:
        """Return the joints so long before the newest posture, (delays, joints, 3), or the oldest ones that are known.

        A joint is NaN where it was unknown in that posture.
        """
        stamps_ns = self._stamps.newest(self._count)
        rows = stamps_ns.searchsorted(stamps_ns[-1] - delays_ns, side="right") - 1
        joints: Array = self._joints.newest(self._count)[rows.clip(0)]
        return joints


class RecentObjects:
    """Where each object was over the last two seconds, and the names of all."""

    def __init__(self) -> None:
        self._tracks: dict[int, tuple[deque[int], deque[Array]]] = {}
        self._names: dict[int, str] = {}
        self._session_id = ""

    def append(self, sample: ObjectsSample) -> None:
        """Add the objects of the next image; those not seen for long, and of another session, are forgotten."""
        if sample.session_id != self._session_id:
            self.clear()
            self._session_id = sample.session_id
        for number, position_m in sample.positions_m.items():
            stamps_ns, places_m = self._tracks.setdefault(
                number, (deque(maxlen=LATEST_ROWS), deque(maxlen=LATEST_ROWS))
            )
            while len(stamps_ns) > 1 and stamps_ns[1] < sample.stamp_ns - TRACK_NS:
                stamps_ns.popleft()
                places_m.popleft()
            stamps_ns.append(sample.stamp_ns)
            places_m.append(np.asarray(position_m, np.float64))
        self._names |= sample.names
        gone = [number for number, (at_ns, _) in self._tracks.items() if at_ns[-1] < sample.stamp_ns - KNOWN_NS]
        for number in gone:
            del self._tracks[number], self._names[number]

    def __bool__(self) -> bool:
        return bool(self._tracks)

    def clear(self) -> None:
        """Forget everything."""
        self._tracks.clear()
        self._names.clear()

    def at(self, stamp_ns: int, delay_ns: int) -> tuple[dict[int, str], Array]:
        """Return the known objects' names by number, and where each was at a stamp and `delay_ns` before, (n, 2, 3).

        Both are `OBJECTS_LATE_NS` older than told.
        """
        names, places = {}, []
        for number, (stamps_ns, places_m) in sorted(self._tracks.items()):
            now = bisect_right(stamps_ns, stamp_ns - OBJECTS_LATE_NS)
            if now and stamps_ns[now - 1] >= stamp_ns - KNOWN_NS:
                before = bisect_right(stamps_ns, stamp_ns - OBJECTS_LATE_NS - delay_ns)
                names[number] = self._names[number]
                places.append((places_m[now - 1], places_m[max(before - 1, 0)]))
        return names, np.array(places).reshape(-1, 2, 3)
