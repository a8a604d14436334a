"""The preprocessor's pure step: each agent of a skeleton frame becomes one posture."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from actum import geometry, keys
from actum.arrays import Array, joints_to_array, joints_to_list
from actum.commands import Command
from actum.core import steps
from actum.limits import MOST_STREAMS
from actum.messages import Agent, Joint, Message, Posture, Skeleton
from actum.node import Counters, Tick
from actum.parameters import LiveParameters
from actum.skeletons import INDEX, JOINTS
from actum.stamps import LostFrames, Order, StampGuard
from pose_preprocessor.body import body_of, known_body
from pose_preprocessor.bridging import Bridge
from pose_preprocessor.frame_checks import BadFrameError, check_frame
from pose_preprocessor.heading import PAIRS, TUNED, HeadingFilter
from pose_preprocessor.missing_joints import RecentlyMissing
from pose_preprocessor.part_motion import PART_OF, PartMotionFilter
from pose_preprocessor.settings import Settings

_TORSO = INDEX["torso"]
ALWAYS = (_TORSO, INDEX["neck"])
"""The joints that every valid posture has, measured or bridged."""

SEVERAL_CAMERAS = 16
"""Entries in the cache of rotations to a level camera: a camera that stands has one."""
LIVE = ("reach_limit_m", "bone_limit_m")
"""The settings that may be changed while it runs."""


class _Lists(NamedTuple):
    """What a valid posture says of the body, as its fields of these names."""

    joints_m: list[Joint]
    joints: list[Joint]
    upright: list[Joint]
    ego_from_camera: list[float]
    motion: list[float]


@dataclass
class _Person:
    """An agent's last usable joints, as they were received, and its filters."""

    joints: list[Joint] | None = None
    bridge: Bridge = field(default_factory=Bridge)
    motion: PartMotionFilter = field(default_factory=PartMotionFilter)
    heading: HeadingFilter = field(default_factory=HeadingFilter)

    def lists(self, frame: Skeleton, joints: list[Joint], limits_m: tuple[float, float]) -> _Lists:
        """Advance the filters by the joints of a frame, and return what its posture says of the body.

        Raises:
            BadFrameError: the joints cannot be used, or are those of the frame before.
            DegenerateError: the egocentric frame is not defined.
        """
        body = known_body(joints, *limits_m)
        if body is None or steps is None:
            return self._lists(frame, joints, limits_m)
        self._keep(frame.stamp_ns, joints, body[: 3 * len(JOINTS)].reshape(-1, 3), ())
        level = None if frame.up_in_camera is None else _level_from_camera(tuple(frame.up_in_camera))
        elapsed_s, gain = self.heading.elapsed_s(frame.stamp_ns), self.motion.gain(frame.stamp_ns)
        return _Lists._make(
            steps.posture(
                body, level, self.heading.state, elapsed_s, PAIRS, TUNED, geometry.SMALLEST_M, self.motion.smooth, gain,
                _TORSO, PART_OF,
            )
        )  # fmt: skip

    def _lists(self, frame: Skeleton, joints: list[Joint], limits_m: tuple[float, float]) -> _Lists:
        """Return the same as `lists`, in NumPy: of joints some of which are not known or not usable."""
        missing = [index for index, joint in enumerate(joints) if joint is None]
        measured = joints_to_array(joints)
        bridged = self.bridge.filled(frame.stamp_ns, measured, missing) if missing else measured
        check_frame(bridged, [index for index in missing if np.isnan(bridged[index, 0])], *limits_m)
        body = body_of(bridged)
        self._keep(frame.stamp_ns, joints, bridged, missing)
        if missing:
            body.metric_ego[[index for index in missing if index not in ALWAYS]] = np.nan
        return _Lists(
            joints_to_list(body.metric_ego),
            joints_to_list(body.scaled_ego),
            joints_to_list(self._upright(frame.stamp_ns, bridged, body.scaled, frame.up_in_camera)),
            geometry.flat(body.ego_from_camera),
            self.motion.step(frame.stamp_ns, bridged),
        )

    def _keep(self, stamp_ns: int, joints: list[Joint], bridged: Array, missing: Sequence[int]) -> None:
        """Remember usable joints, as they were received and with missing ones bridged.

        Raises:
            BadFrameError: they are those of the frame before.
        """
        if joints == self.joints:
            raise BadFrameError(
                "repeated_joints",
                "all joints equal those of the previous frame, so the body tracker lost the person or is frozen: if "
                "this lasts, step into view, or restart the sensor service",
            )
        self.joints = joints
        self.bridge.keep(stamp_ns, bridged, missing)

    def _upright(self, stamp_ns: int, metric: Array, scaled: Array, up_in_camera: list[float] | None) -> Array:
        """Advance the heading by the metric joints, and return the scaled ones in the upright frame, (15, 3).

        Args:
            stamp_ns: of the frame.
            metric: (15, 3), camera frame.
            scaled: the same with standard bones.
            up_in_camera: the direction against gravity, camera frame; None where the camera is level.
        """
        if up_in_camera is not None:
            level_from_camera = _level_from_camera(tuple(up_in_camera))
            metric, scaled = metric @ level_from_camera.T, scaled @ level_from_camera.T
        return geometry.upright(scaled, *self.heading.step(stamp_ns, metric))


@lru_cache(SEVERAL_CAMERAS)
def _level_from_camera(up_in_camera: tuple[float, ...]) -> Array:
    return geometry.untilted_from_camera(up_in_camera)


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
        person = self._persons.get(agent.agent)
        if person is None:
            person = self._persons[agent.agent] = _Person()
        limits_m = self._settings.reach_limit_m, self._settings.bone_limit_m
        lists = person.lists(frame, agent.joints, limits_m)
        if None in agent.joints:
            missing = [name for name, joint in zip(JOINTS, agent.joints, strict=True) if joint is None]
            self._missing.note(frame.stamp_ns, missing)
        return Posture.of_checked(
            **self._common_fields(frame, agent.agent, missed, present),
            **dict(zip(_Lists._fields, lists, strict=True)),
            depth_std_m=agent.depth_std_m,
            up_in_camera=frame.up_in_camera,
        )

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
