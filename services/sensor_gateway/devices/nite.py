"""People tracked by NiTE 2 in depth images, if its library is installed; no pose model is needed then."""

import logging
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import chdir, contextmanager, suppress
from typing import Any

from actum.messages import Agent, Joint
from actum.skeletons import INDEX, JOINTS, to_actum
from sensor_gateway.captured_picture import DepthPicture, Picture, UsersPicture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.openni2 import OpenNi2Capture
from sensor_gateway.devices.openni2_library import library
from sensor_gateway.devices.openni2_streams import Streams
from sensor_gateway.known_joints import known_joints

log = logging.getLogger("actum")

FOLDERS = "NITE2_REDIST64", "NITE2_REDIST"
"""Environment variables that NiTE's installer sets to the folder with its library and data."""

MILLIMETRES = 1000.0
"""NiTE's units of length in a metre."""
LEFT_SHOULDER = INDEX["left_shoulder"]
RIGHT_SHOULDER = INDEX["right_shoulder"]


def _opposite(name: str) -> str:
    side, _, joint = name.partition("_")
    return f"{({'left': 'right', 'right': 'left'})[side]}_{joint}" if joint else name


OTHER_SIDE = tuple(INDEX[_opposite(name)] for name in JOINTS)
"""For each joint (15), the index of its counterpart on the other side; a middle joint is its own counterpart."""


def nite() -> Any | None:
    """Start NiTE if its installer's environment variables are set and it can be started; None otherwise.

    Raises:
        OpenNiError: OpenNI 2 or its bindings are not installed.
    """
    folders = [os.environ[name] for name in FOLDERS if name in os.environ]
    if not folders:
        return None
    library()
    from openni import nite2
    from openni.utils import InitializationError

    try:
        nite2.initialize(folders)
    except InitializationError as error:
        log.warning(
            "NiTE (body tracking in depth images) cannot be started (%s), so people are found in the colour "
            "images instead",
            error,
        )
        return None
    return nite2


class NiteCapture(OpenNi2Capture):
    """The first connected camera, with the people that NiTE tracks in its depth images, in the dark as well."""

    live = False

    def __init__(self, nite2: Any, size: tuple[int, int] | None = None, field_of_view_deg: float = 60.0) -> None:
        super().__init__(size, field_of_view_deg)
        self._nite2 = nite2
        self._tracker: Any = None
        self._users = Users(self._follow)

    def next(self, patience_s: float) -> Picture | None:
        """Return a picture newer than the last with its people, or None if none comes within `patience_s`.

        Raises:
            CameraLostError: there is no camera, it cannot be used, was unplugged, has been silent for too long, or NiTE
                fails.
        """
        picture = super().next(patience_s)
        if not isinstance(picture, DepthPicture):
            return None
        with _nite_errors_as_lost(), self._tracker.read_frame() as frame:
            agents = self._users.agents(frame.users)
        return UsersPicture(picture.image_bgr, picture.stamp_ns, picture.depth_m, picture.lens, tuple(agents))

    def close(self) -> None:
        """Release the camera."""
        tracker, self._tracker = self._tracker, None
        if tracker is not None:
            with suppress(CameraLostError), _nite_errors_as_lost():
                tracker.close()
        super().close()

    def _opened(self) -> Streams:
        from openni.utils import NiteError

        streams = super()._opened()
        try:
            with chdir(self._nite2.loaded_dll_directory):  # NiTE looks for its data in the working directory
                self._tracker = self._nite2.UserTracker(streams.device)
        except NiteError as error:
            streams.close()
            raise CameraLostError(
                f"NiTE, which finds people in depth images, cannot use this camera ({error}): unset NITE2_REDIST64 "
                "and NITE2_REDIST, and restart the gateway. The gateway then finds people with the pose model"
            ) from None
        return streams

    def _follow(self, user: int) -> None:
        self._tracker.start_skeleton_tracking(user)


@contextmanager
def _nite_errors_as_lost() -> Iterator[None]:
    from openni.utils import NiteError

    try:
        yield
    except NiteError as error:
        raise CameraLostError(f"NiTE says: {error}") from None


class Users:
    """Makes agents of NiTE's users; `follow` starts the skeleton tracking of a new user.

    NiTE reuses the number of a lost user; agents' numbers are never used again. NiTE assumes that everybody faces the
    camera, and exchanges left and right if its images are mirrored. Whether it does is decided for each user by the
    side of the left shoulder in the first skeleton.
    """

    def __init__(self, follow: Callable[[int], None]) -> None:
        self._follow = follow
        self._agents: dict[int, int] = {}
        self._sides_swapped: dict[int, bool] = {}
        self._next = 1

    def agents(self, users: Sequence[Any]) -> list[Agent]:
        """Return the agents of the users whose skeleton is tracked."""
        for user in users:
            if user.is_lost():
                self._agents.pop(user.id, None)
                self._sides_swapped.pop(user.id, None)
            elif user.id not in self._agents:
                self._agents[user.id], self._next = self._next, self._next + 1
                self._follow(user.id)
        return [self._agent(user) for user in users if user.id in self._agents and _is_tracked(user)]

    def _agent(self, user: Any) -> Agent:
        joints: list[Joint] = to_actum([_in_metres(joint.position) for joint in user.skeleton.joints], "nite2-15")
        confidence = to_actum([float(joint.positionConfidence) for joint in user.skeleton.joints], "nite2-15")
        left, right = joints[LEFT_SHOULDER], joints[RIGHT_SHOULDER]
        assert left is not None and right is not None
        if self._sides_swapped.setdefault(user.id, left[0] < right[0]):
            joints, confidence = [joints[i] for i in OTHER_SIDE], [confidence[i] for i in OTHER_SIDE]
        return Agent(agent=self._agents[user.id], joints=known_joints(joints, confidence), confidence=confidence)


def _is_tracked(user: Any) -> bool:
    return bool(user.skeleton.state.value == user.skeleton.state.NITE_SKELETON_TRACKED)


def _in_metres(position: Any) -> Joint:
    """Turn NiTE's position (x right, y up, z forward; mm) into the camera frame (x right, y down, z forward; m)."""
    return [position.x / MILLIMETRES, -position.y / MILLIMETRES, position.z / MILLIMETRES]
