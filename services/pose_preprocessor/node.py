"""The preprocessor's pure step: each agent of a skeleton frame becomes one posture."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from actum import geometry, keys
from actum.arrays import Array, joints_to_array, joints_to_list
from actum.commands import Command
from actum.limits import MOST_STREAMS
from actum.messages import Agent, Joint, Message, Posture, Skeleton
from actum.node import Counters, Tick
from actum.parameters import LiveParameters
from actum.skeletons import INDEX, JOINTS
from actum.stamps import LostFrames, Order, StampGuard
from pose_preprocessor.body import Body, body_of, body_of_known
from pose_preprocessor.bridging import Bridge
from pose_preprocessor.frame_checks import BadFrameError, check_frame
from pose_preprocessor.heading import HeadingFilter
from pose_preprocessor.missing_joints import RecentlyMissing
from pose_preprocessor.part_motion import PartMotionFilter
from pose_preprocessor.settings import Settings

_TORSO = INDEX["torso"]
ALWAYS = (_TORSO, INDEX["neck"])
"""The joints that every valid posture has, measured or bridged."""

LIVE = ("reach_limit_m", "bone_limit_m")
"""The settings that may be changed while it runs."""


@dataclass
class _Person:
    """An agent's last usable joints, as they were received, and its filters."""

    joints: list[Joint] | None = None
    bridge: Bridge = field(default_factory=Bridge)
    motion: PartMotionFilter = field(default_factory=PartMotionFilter)
    heading: HeadingFilter = field(default_factory=HeadingFilter)

    def upright(self, stamp_ns: int, metric: Array, scaled: Array, up_in_camera: list[float] | None) -> Array:
        """Advance the heading by the metric joints, and return the scaled ones in the upright frame, (15, 3).

        Args:
            stamp_ns: of the frame.
            metric: (15, 3), camera frame.
            scaled: the same with standard bones.
            up_in_camera: the direction against gravity, camera frame; None where the camera is level.
        """
        if up_in_camera is not None:
            level_from_camera = geometry.untilted_from_camera(up_in_camera)
            metric, scaled = metric @ level_from_camera.T, scaled @ level_from_camera.T
        return geometry.upright(scaled, *self.heading.step(stamp_ns, metric))


class PosePreprocessor:
    """Rejects bad frames; expresses the others in the actor's body frames, scaled and metric (paper, section 2.1)."""

    name = "pose_preprocessor"
    inputs = (keys.SKELETON,)

    def __init__(self, settings: Settings) -> None:
        self.counters = Counters()
        self._use_settings(settings)
        self._parameters = LiveParameters(settings, LIVE, self._use_settings)
        self._order = StampGuard()
        self._lost = LostFrames()
        self._missing = RecentlyMissing(self.counters)
        self._persons: dict[int, _Person] = {}
        self._previous_ns: int | None = None

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """Reading and changing settings while it runs."""
        return self._parameters.commands

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Turn a skeleton into one posture per agent, or one that is not valid, for agent 0, when nobody is there."""
        if not isinstance(message, Skeleton):
            return []
        order = self._order.judge(message.stamp_ns, message.session_id)
        if order is Order.STALE:
            self.counters.reject("stale_stamp", f"skeleton at {message.stamp_ns} after {self._order.newest_ns}")
            return []
        if order is Order.RESTART:
            self._persons.clear()
            self._previous_ns = None
        postures = self._postures(message, self._lost.before(message.seq, order))
        self._previous_ns = message.stamp_ns
        # people who have left are forgotten: a tracker that numbers them anew at each return would pile them up
        present = {agent.agent for agent in message.agents}
        for agent in self._persons.keys() - present:
            if self._persons[agent].motion.restarts_at(message.stamp_ns):
                del self._persons[agent]
        absent = [agent for agent in self._persons if agent not in present]
        for agent in absent[: max(len(self._persons) - MOST_STREAMS, 0)]:
            del self._persons[agent]
            self.counters.reject("too_many_people", f"more than {MOST_STREAMS}: agent {agent} is forgotten")
        self._missing.report(message.stamp_ns)
        return postures

    def _use_settings(self, settings: Settings) -> None:
        self._settings = settings

    def _postures(self, message: Skeleton, missed: int) -> list[Posture]:
        agents = list({agent.agent: agent for agent in message.agents}.values())
        if len(agents) < len(message.agents):
            self.counters.reject("repeated_agent", f"{len(message.agents)} agents, {len(agents)} distinct")
        if not agents:
            return [self._invalid(message, 0, message.reason or "no person", missed, [])]
        present = [agent.agent for agent in agents]
        return [self._posture(message, agent, missed, present) for agent in agents]

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
        missing = [index for index, joint in enumerate(agent.joints) if joint is None]
        person = self._persons.setdefault(agent.agent, _Person())
        measured = joints_to_array(agent.joints)
        bridged = person.bridge.filled(frame.stamp_ns, measured, missing) if missing else measured
        body = self._body(bridged, missing)
        if agent.joints == person.joints:
            raise BadFrameError(
                "repeated_joints",
                "all joints equal those of the previous frame, so the sensor lost the person or is frozen",
            )
        person.joints = agent.joints
        person.bridge.keep(frame.stamp_ns, bridged, missing)
        self._missing.note(frame.stamp_ns, [JOINTS[index] for index in missing])
        if missing:
            body.metric_ego[[index for index in missing if index not in ALWAYS]] = np.nan
            measured[_TORSO] = bridged[_TORSO]
        return Posture(
            **self._common_fields(frame, agent.agent, missed, present),
            joints_m=joints_to_list(body.metric_ego),
            joints=joints_to_list(body.scaled_ego),
            upright=joints_to_list(person.upright(frame.stamp_ns, bridged, body.scaled, frame.up_in_camera)),
            ego_from_camera=geometry.flat(body.ego_from_camera),
            motion=person.motion.step(frame.stamp_ns, measured),
            depth_std_m=agent.depth_std_m,
            up_in_camera=frame.up_in_camera,
        )

    def _body(self, joints: Array, missing: list[int]) -> Body:
        """Return the body of joints (15, 3), of which missing ones are bridged where that is possible.

        Raises:
            BadFrameError: they cannot be used.
            DegenerateError: the egocentric frame is not defined.
        """
        limits_m = self._settings.reach_limit_m, self._settings.bone_limit_m
        body = None if missing else body_of_known(joints, *limits_m)
        if body is None:
            check_frame(joints, [index for index in missing if np.isnan(joints[index, 0])], *limits_m)
            body = body_of(joints)
        return body

    def _invalid(self, frame: Skeleton, agent: int, reason: str, missed: int, present: list[int]) -> Posture:
        return Posture(
            **self._common_fields(frame, agent, missed, present),
            valid=False,
            reason=reason,
            joints_m=None,
            joints=None,
            upright=None,
            ego_from_camera=None,
            motion=None,
        )

    def _common_fields(self, frame: Skeleton, agent: int, missed: int, present: list[int]) -> dict[str, Any]:
        return {
            "stamp_ns": frame.stamp_ns,
            "sensor": frame.sensor,
            "agent": agent,
            "agents": present,
            "previous_ns": self._previous_ns,
            "missed": missed,
            "session_id": frame.session_id,
        }
