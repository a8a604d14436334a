"""Puts together, from what comes about each body and in any order, one skeleton message for each captured image."""

from collections import OrderedDict
from collections.abc import Iterable, Iterator, Sequence

from actum.messages import MOST_AGENTS, Agent, Joint, Skeleton
from actum.node import SECOND_NS, Counters
from actum.stamps import Order, StampGuard
from ros2_bridge.hri.human_model import Link
from ros2_bridge.hri_in.body import Body, Found
from ros2_bridge.hri_in.description import USUAL_LINKS
from ros2_bridge.hri_in.transform_tree import TransformTree
from ros2_bridge.rotations import rotated

PATIENCE_NS = 100_000_000
"""How much newer (ns) the newest stamp may be before an image's skeleton is put although something of it is missing."""
RESTARTED_NS = 2 * SECOND_NS
"""How far (ns) the stamps of bodies step back where time begins anew. Recordings of some seconds that are played in a
loop, simulations that are reset, and clocks that are set give nothing that names the new run."""
MOST_OPEN = 32
"""Most images whose skeletons wait for more: a third of a second at 100 Hz."""
MOST_NUMBERED = 4096
"""Bodies whose numbers are remembered. One that comes back after more others gets a new number."""
OPTICAL = "optical"
"""What names of frames with z along the line of sight contain (REP 103); in all others that are roots z is up."""

LATE = "late body data, left out"
"""What is counted where joints of a body come once the skeleton of their stamp, or a newer one, was put without."""


class SkeletonAssembler:
    """Collects what is known of the bodies at each stamp, and gives a skeleton once it is whole or overdue."""

    def __init__(self, sensor: str, optical_frame: str, counters: Counters) -> None:
        self.tree = TransformTree()
        self.bodies: dict[str, Body] = {}
        self.session = ""
        self._sensor, self._optical_frame, self._counters = sensor, optical_frame, counters
        self._numbers: OrderedDict[str, int] = OrderedDict()
        self._models: OrderedDict[str, Sequence[Link]] = OrderedDict()
        self._highest_number = self._runs = 0
        self._order = StampGuard(RESTARTED_NS)
        self._open: dict[int, dict[str, Found]] = {}
        self._newest_put_ns = self._judged_ns = -1

    def track(self, stamp_ns: int | None, ids: Sequence[str]) -> Iterator[Skeleton]:
        """Note who is there from now on, and yield the skeletons that are due.

        Without a stamp, a list of nobody gives no skeleton.
        """
        if len(ids) > MOST_AGENTS:
            self._counters.reject("too_many_bodies", f"{len(ids)} bodies; the first {MOST_AGENTS} are used")
        self.bodies = {each: self.bodies.get(each) or self._body(each) for each in ids[:MOST_AGENTS]}
        for body_id in self._models.keys() & self.bodies:
            self._models.move_to_end(body_id)
        if stamp_ns is not None:
            yield from self.advance(stamp_ns, ids)

    def describe(self, body_id: str, links: Sequence[Link]) -> None:
        """Take the links of the model of a body, also of one that is not tracked yet.

        The model of a body that has been gone for longest makes room.
        """
        self._models[body_id] = links
        self._models.move_to_end(body_id)
        if len(self._models) > MOST_AGENTS:
            self._models.popitem(last=False)
        if body_id in self.bodies:
            self.bodies[body_id].describe(links)

    def owner(self, frame: str) -> str | None:
        """Return the id of the tracked body to which a frame belongs by its name; None where it is no body's.

        Of ids of which one ends in the other, such as `left_1` and `1`, it is the longer.
        """
        return max((body_id for body_id in self.bodies if frame.endswith(f"_{body_id}")), key=len, default=None)

    def advance(self, stamp_ns: int, ids: Sequence[str]) -> Iterator[Skeleton]:
        """Look again at bodies of which something new is known at a stamp, and yield the skeletons that are due.

        A stamp at which no joints of bodies are known begins no image: a list of bodies, or a frame whose name only
        looks like a body's, may be newer than the joints that come next.
        """
        bodies = {body_id: self.bodies[body_id] for body_id in ids if body_id in self.bodies}
        found = {body_id: body.find(self.tree, stamp_ns) for body_id, body in bodies.items()}
        known = {body_id: joints for body_id, joints in found.items() if joints is not None}
        if known or not self.bodies:
            yield from self._take(stamp_ns, known)

    def _take(self, stamp_ns: int, found: dict[str, Found]) -> Iterator[Skeleton]:
        """Add joints of bodies to the skeleton of a stamp, and yield the skeletons that are due."""
        if self._has_restarted(stamp_ns):
            self._begin_anew()
        if stamp_ns <= self._newest_put_ns:
            self._note_late(found, stamp_ns)
            return
        self._open.setdefault(stamp_ns, {}).update(found)
        yield from self._due()

    def _note_late(self, ids: Iterable[str], stamp_ns: int) -> None:
        """Count bodies that a skeleton did without; one that is late by little is waited for from now on."""
        for body in (self.bodies[body_id] for body_id in ids):
            if not body.is_awaited:
                self._counters.counts[LATE] += 1
                body.is_awaited = stamp_ns > self._newest_put_ns - PATIENCE_NS

    def _has_restarted(self, stamp_ns: int) -> bool:
        """Tell whether time began anew. Several messages have one stamp, which is judged once."""
        if stamp_ns == self._judged_ns:
            return False
        self._judged_ns = stamp_ns
        return self._order.judge(stamp_ns) is Order.RESTART

    def _due(self) -> Iterator[Skeleton]:
        """Yield the skeletons that are due, after which others may be whole, in the order of their stamps."""
        while due := self._due_stamps():
            for stamp_ns in due:
                yield from self._skeleton(stamp_ns, self._open.pop(stamp_ns))

    def _due_stamps(self) -> list[int]:
        """Return the stamps up to the newest of a whole skeleton, and those that are overdue or too many."""
        overdue_ns = max(self._open, default=0) - PATIENCE_NS
        whole_ns = max((stamp_ns for stamp_ns in self._open if self._is_whole(stamp_ns)), default=-1)
        spare = len(self._open) - MOST_OPEN
        waiting = enumerate(sorted(self._open))
        return [stamp_ns for i, stamp_ns in waiting if stamp_ns <= max(overdue_ns, whole_ns) or i < spare]

    def _is_whole(self, stamp_ns: int) -> bool:
        found = self._open[stamp_ns]
        return all(body.is_whole(found.get(body_id)) for body_id, body in self.bodies.items())

    def _skeleton(self, stamp_ns: int, found: dict[str, Found]) -> Iterator[Skeleton]:
        """Yield the skeleton of an image; none where bodies are tracked, and no joint of any is known."""
        self._newest_put_ns = stamp_ns
        for body_id, body in self.bodies.items():
            body.use(found.get(body_id))
        shown = [(body.number, found[body_id]) for body_id, body in self.bodies.items() if body_id in found]
        if self.bodies and not shown:
            return
        yield Skeleton(
            stamp_ns=stamp_ns,
            sensor=self._sensor,
            agents=[_agent(number, joints) for number, joints in shown],
            up_in_camera=self._up_in_camera(stamp_ns),
            session_id=f"{self.session}.{self._runs}",
        )

    def _up_in_camera(self, stamp_ns: int) -> list[float] | None:
        """Return the z axis of the root of the camera's tree, which points up (REP 103); None where it has none."""
        root, camera = self.tree.top(self._optical_frame, stamp_ns)
        if OPTICAL in root or root == self._optical_frame:
            return None
        return list(rotated(camera.inverse().xyzw, (0, 0, 1)))

    def _body(self, body_id: str) -> Body:
        """Return a body that has just come, with its number of earlier or a new one."""
        if body_id not in self._numbers:
            self._highest_number += 1
            self._numbers[body_id] = self._highest_number
        self._numbers.move_to_end(body_id)
        if len(self._numbers) > MOST_NUMBERED:
            self._numbers.popitem(last=False)
        links = self._models.get(body_id, USUAL_LINKS)
        return Body(body_id, self._numbers[body_id], self._optical_frame, links)

    def _begin_anew(self) -> None:
        """Forget what was known at times that are not those of now: a recording is played again, or a clock was set."""
        self._runs += 1
        self._newest_put_ns = -1
        self._open.clear()
        self.tree.forget_moving()


def _agent(number: int, found: Found) -> Agent:
    joints: list[Joint] = [None if joint is None else list(joint) for joint in found.joints]
    return Agent(agent=number, joints=joints, confidence=[0.0 if joint is None else 1.0 for joint in joints])
