"""One body that others track: its number with us, its model, its joint angles of late, and where its joints are."""

from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ros2_bridge.hri.human_model import Link, joints_of_model, link_places
from ros2_bridge.hri.placements import Placement
from ros2_bridge.hri_in.body_joints import BODY, joints_of
from ros2_bridge.hri_in.transform_tree import HISTORY, TransformTree
from ros2_bridge.rotations import Point


class Found(NamedTuple):
    """The joints of a body at one instant.

    Attributes:
        joints: (m) in our order, in the camera's optical frame; None where one is unknown.
        by_frames: whether they are frames of TF; otherwise the body's model's, from angles of joints.
    """

    joints: list[Point | None]
    by_frames: bool

    @property
    def known(self) -> frozenset[int]:
        """The indices of the joints that are known."""
        return frozenset(i for i, joint in enumerate(self.joints) if joint is not None)


class Body:
    """A tracked body.

    Attributes:
        number: the agent's number in our messages.
        is_awaited: whether a skeleton waits for the body's joints.
        has_3d, has_2d: whether joints in space, or points in an image, were received since the last review.
    """

    def __init__(self, body_id: str, number: int, optical_frame: str, links: Sequence[Link]) -> None:
        self.number = number
        self.is_awaited = True
        self.has_3d = self.has_2d = False
        self._suffix = f"_{body_id}"
        self._optical_frame = optical_frame
        self._positions: OrderedDict[int, Mapping[str, float]] = OrderedDict()
        self._links, self._joints = links, joints_of_model(links)
        self._last: Found | None = None

    def describe(self, links: Sequence[Link]) -> None:
        """Take the links of the body's model, in place of those that it had."""
        self._links, self._joints = links, joints_of_model(links)

    def take_positions(self, stamp_ns: int, names: list[str], positions: list[float]) -> None:
        """Note angles (rad) and shifts (m) of the model's joints at an instant, by names that end in the body's id."""
        pairs = zip((name.removesuffix(self._suffix) for name in names), positions, strict=False)
        self._positions[stamp_ns] = {name: position for name, position in pairs if name in self._joints}
        if len(self._positions) > HISTORY:
            self._positions.popitem(last=False)

    def find(self, tree: TransformTree, stamp_ns: int) -> Found | None:
        """Return the joints at an instant, of frames if there are any, else of the body's model.

        None where neither is known at that instant.
        """

        def framed(name: str) -> Point | None:
            placed = self._placed(name, tree, stamp_ns)
            return None if placed is None else placed.position_m

        body = self._placed(BODY, tree, stamp_ns)
        found = Found(joints_of(framed, body), by_frames=True)
        if found.known or body is None:
            return found if found.known else None
        return self._modelled(body, stamp_ns)

    def is_whole(self, found: Found | None) -> bool:
        """Tell whether no more is to be waited for: the joints of the last skeleton are there, from the same source."""
        if found is None:
            return not self.is_awaited
        last = self._last
        return last is not None and last.by_frames == found.by_frames and last.known <= found.known

    def use(self, found: Found | None) -> None:
        """Note what the newest skeleton shows of the body; nothing of it is awaited once a skeleton did without."""
        self.is_awaited = found is not None
        if found is not None:
            self._last, self.has_3d = found, True

    def _placed(self, name: str, tree: TransformTree, stamp_ns: int) -> Placement | None:
        """Return where a frame of the body lies in the camera's at an instant; None where that is not known."""
        frame = f"{name}{self._suffix}"
        if not tree.knows(frame):
            return None
        return tree.placement(frame, self._optical_frame, stamp_ns, exactly=self._suffix)

    def _modelled(self, body: Placement, stamp_ns: int) -> Found | None:
        positions = self._positions.get(stamp_ns)
        if positions is None:
            return None
        places = {name: body.at(place) for name, place in link_places(positions, self._links).items()}
        found = Found(joints_of(places.get, body), by_frames=False)
        return found if found.known else None
