"""The preprocessor's pure step: each agent of a skeleton frame becomes one posture."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from actum import geometry, keys
from actum.messages import Agent, Joint, Message, Posture, Skeleton
from actum.node import Counters, Tick
from actum.skeletons import INDEX, JOINTS
from actum.stamps import Order, StampGuard
from pose_preprocessor.checks import BadFrameError, as_array, check, missing_joints
from pose_preprocessor.missing import MissingLately
from pose_preprocessor.person import Person
from pose_preprocessor.settings import Settings

_TORSO = INDEX["torso"]
ALWAYS = (_TORSO, INDEX["neck"])
"""The joints that every valid posture has, if only from a moment before."""


class PosePreprocessor:
    """Rejects bad frames, expresses the others in the actor's own frames, scaled and metric (paper, section 2.1)."""

    name = "pose_preprocessor"
    inputs = (keys.SKELETON,)

    def __init__(self, settings: Settings | None = None) -> None:
        self.counters = Counters()
        self._settings = settings or Settings()
        self._order = StampGuard()
        self._missing = MissingLately(self.counters)
        self._persons: dict[int, Person] = {}
        self._previous_ns: int | None = None
        self._last_seq: int | None = None

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Turn a skeleton into one posture per agent, or one for agent 0 when nobody is there."""
        if not isinstance(message, Skeleton):
            return []
        order = self._order.judge(message.stamp_ns, message.session_id)
        if order is Order.STALE:
            self.counters.reject("stale_stamp", f"skeleton at {message.stamp_ns} after {self._order.newest_ns}")
            return []
        if order is Order.RESTART:
            self._persons.clear()
            self._previous_ns = None
        postures = self._postures(message, self._missed(message, order))
        self._previous_ns = message.stamp_ns
        self._forget_the_gone(message)
        self._missing.report(message.stamp_ns)
        return postures

    def _postures(self, message: Skeleton, missed: int) -> list[Posture]:
        agents = self._distinct_agents(message)
        if not agents:
            return [self._invalid(message, 0, message.reason or "no person", missed, [])]
        present = [agent.agent for agent in agents]
        return [self._posture(message, agent, missed, present) for agent in agents]

    def _missed(self, message: Skeleton, order: Order) -> int:
        last, self._last_seq = self._last_seq, message.seq
        if last is None or message.seq is None or order is Order.RESTART:
            return 0
        return max(message.seq - last - 1, 0)

    def _forget_the_gone(self, frame: Skeleton) -> None:
        """Let go of those who have left: a tracker that numbers people anew at each return would pile them up."""
        present = {agent.agent for agent in frame.agents}
        for agent in self._persons.keys() - present:
            if self._persons[agent].motion.is_over(frame.stamp_ns):
                del self._persons[agent]

    def _distinct_agents(self, message: Skeleton) -> list[Agent]:
        agents = {agent.agent: agent for agent in message.agents}
        if len(agents) < len(message.agents):
            self.counters.reject("repeated_agent", f"{len(message.agents)} agents, {len(agents)} distinct")
        return list(agents.values())

    def _posture(self, frame: Skeleton, agent: Agent, missed: int, present: list[int]) -> Posture:
        if not frame.valid:
            self.counters.reject("invalid_skeleton", f"agent {agent.agent} at {frame.stamp_ns}: {frame.reason}")
            return self._invalid(frame, agent.agent, frame.reason or "invalid skeleton", missed, present)
        try:
            return self._valid(frame, agent, missed, present)
        except (BadFrameError, geometry.DegenerateError) as error:
            kind = error.kind if isinstance(error, BadFrameError) else "coincident_joints"
            self.counters.reject(kind, f"agent {agent.agent} at {frame.stamp_ns}: {error}")
            return self._invalid(frame, agent.agent, f"{kind}: {error}", missed, present)

    def _valid(self, frame: Skeleton, agent: Agent, missed: int, present: list[int]) -> Posture:
        missing = missing_joints(agent.joints)
        person = self._persons.setdefault(agent.agent, Person())
        measured = as_array(agent.joints)
        bridged = self._usable(frame.stamp_ns, agent, person, measured, missing)
        both = np.stack([bridged, geometry.scaled(bridged)])
        egos = geometry.ego_from_camera(both)
        metric_ego, scaled_ego = geometry.apply(egos, both)
        person.joints = agent.joints
        person.bridge.keep(frame.stamp_ns, bridged, missing)
        self._missing.note(frame.stamp_ns, [JOINTS[index] for index in missing])
        metric_ego[[index for index in missing if index not in ALWAYS]] = np.nan
        measured[_TORSO] = bridged[_TORSO]
        return Posture(
            stamp_ns=frame.stamp_ns,
            sensor=frame.sensor,
            agent=agent.agent,
            joints_m=_listed(metric_ego),
            joints=_listed(scaled_ego),
            upright=_listed(person.upright(frame.stamp_ns, *_untilted(both, frame.up_in_camera))),
            ego_from_camera=geometry.flat(egos[0]),
            motion=person.motion.step(frame.stamp_ns, measured),
            depth_std_m=agent.depth_std_m,
            up_in_camera=frame.up_in_camera,
            agents=present,
            previous_ns=self._previous_ns,
            missed=missed,
            session_id=frame.session_id,
        )

    def _usable(
        self, stamp_ns: int, agent: Agent, person: Person, measured: NDArray[np.float64], missing: list[int]
    ) -> NDArray[np.float64]:
        bridged = person.bridge.over(stamp_ns, measured, missing) if missing else measured
        unknown = [index for index in missing if np.isnan(bridged[index, 0])]
        check(bridged, unknown, self._settings.reach_limit_m, self._settings.bone_limit_m)
        if agent.joints == person.joints:
            raise BadFrameError("repeated_joints", "the same joints as in the frame before")
        return bridged

    def _invalid(self, frame: Skeleton, agent: int, reason: str, missed: int, present: list[int]) -> Posture:
        return Posture(
            stamp_ns=frame.stamp_ns,
            sensor=frame.sensor,
            valid=False,
            reason=reason,
            agent=agent,
            joints_m=None,
            joints=None,
            upright=None,
            ego_from_camera=None,
            motion=None,
            agents=present,
            previous_ns=self._previous_ns,
            missed=missed,
            session_id=frame.session_id,
        )


def _untilted(joints: NDArray[np.float64], up_in_camera: list[float] | None) -> NDArray[np.float64]:
    return joints if up_in_camera is None else joints @ geometry.untilted_from_camera(up_in_camera).T


def _listed(joints: NDArray[np.float64]) -> list[Joint]:
    listed: list[Joint] = joints.tolist()
    if math.isnan(joints.sum()):
        return [None if unknown else joint for joint, unknown in zip(listed, np.isnan(joints[:, 0]), strict=True)]
    return listed
