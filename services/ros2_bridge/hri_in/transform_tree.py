"""TF: where frames lie in their parents, of late and for good, and the way from one frame to another."""

from collections import OrderedDict
from collections.abc import Iterator
from typing import NamedTuple

from actum.node import SECOND_NS
from ros2_bridge.hri.placements import Placement

MOST_FRAMES = 4096
"""Most frames that move, and most that do not: a robot has hundreds, each body some thirty. The frame that was silent
or unused for longest is forgotten."""
HISTORY = 32
"""Placements kept of each frame: a third of a second at 100 Hz, a second of bodies."""
NEAREST_NS = SECOND_NS // 2
"""How far (ns) the placement of a frame that is no body's may be from the wanted instant: the slowest robots say twice
a second how their cameras stand."""
DEEPEST = 64
"""Most frames from one to the root: a chain that is longer is a loop."""


class Edge(NamedTuple):
    """A frame's parent, and where the frame lies in it."""

    parent: str
    placement: Placement


class TransformTree:
    """The transforms of `/tf` and `/tf_static`; names have no slash before them."""

    def __init__(self) -> None:
        self._moving: OrderedDict[str, OrderedDict[int, Edge]] = OrderedDict()
        self._fixed: OrderedDict[str, Edge] = OrderedDict()

    def put(self, child: str, stamp_ns: int, edge: Edge) -> None:
        """Note where a frame lies in its parent at an instant (ns)."""
        history = self._moving.setdefault(child, OrderedDict())
        self._moving.move_to_end(child)
        history[stamp_ns] = edge
        if len(history) > HISTORY:
            history.popitem(last=False)
        _forget_first(self._moving)

    def put_fixed(self, child: str, edge: Edge) -> None:
        """Note where a frame lies in its parent at all times."""
        self._fixed[child] = edge
        self._fixed.move_to_end(child)
        _forget_first(self._fixed)

    def forget_moving(self) -> None:
        """Forget all frames that move: time began anew."""
        self._moving.clear()

    def knows(self, frame: str) -> bool:
        """Tell whether any transform has placed a frame of late."""
        return frame in self._moving or frame in self._fixed

    def placement(self, frame: str, root: str, stamp_ns: int, exactly: str) -> Placement | None:
        """Return where a frame lies in another at an instant (ns); None if no transforms lead from one to the other.

        Frames that move and whose names end in `exactly` have to be placed at that very instant; for others the nearest
        will do.
        """
        up = dict(self._path(frame, stamp_ns, exactly))
        if root in up:
            return up[root]
        down = dict(self._path(root, stamp_ns, exactly))
        meeting = next((each for each in down if each in up), None)
        return None if meeting is None else down[meeting].inverse().of(up[meeting])

    def top(self, frame: str, stamp_ns: int) -> tuple[str, Placement]:
        """Return the root of a frame's tree at an instant (ns), and where the frame lies in it."""
        *_, found = self._path(frame, stamp_ns, exactly="")
        return found

    def _path(self, frame: str, stamp_ns: int, exactly: str) -> Iterator[tuple[str, Placement]]:
        """Yield a frame and its ancestors, nearest first, each with where the frame lies in it."""
        lies = Placement()
        for _ in range(DEEPEST):
            yield frame, lies
            edge = self._edge(frame, stamp_ns, exactly)
            if edge is None:
                return
            frame, lies = edge.parent, edge.placement.of(lies)

    def _edge(self, child: str, stamp_ns: int, exactly: str) -> Edge | None:
        if child in self._fixed:
            self._fixed.move_to_end(child)
            return self._fixed[child]
        history = self._moving.get(child)
        if not history:
            return None
        if stamp_ns in history or (exactly and child.endswith(exactly)):
            return history.get(stamp_ns)
        nearest_ns = min(history, key=lambda each: abs(each - stamp_ns))
        return history[nearest_ns] if abs(nearest_ns - stamp_ns) <= NEAREST_NS else None


def _forget_first(frames: OrderedDict[str, OrderedDict[int, Edge]] | OrderedDict[str, Edge]) -> None:
    if len(frames) > MOST_FRAMES:
        frames.popitem(last=False)
