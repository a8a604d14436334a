"""Draws the joints found in a video into some of its pictures."""

from pathlib import Path

import numpy as np

from actum.arrays import Pixels
from actum.messages import Skeleton
from actum.node import SECOND_NS, Counters
from actum_command.skeleton_overlay import drawn
from sensor_gateway.cameras import estimator_of
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.video import pictures_of
from sensor_gateway.optics import Optics
from sensor_gateway.perceiver import Perceiver
from sensor_gateway.settings import Settings


def joint_pictures(video: Path, settings: Settings, optics: Optics, count: int) -> tuple[list[Pixels], int]:
    """Find the joints in every frame of a video as the camera source does, and draw them into `count` of its frames.

    Return the pictures drawn, (height, width, 3) BGR, evenly from the first frame to the last, and how many frames
    there are. The video is decoded once more to count its frames, so that only those drawn are kept in memory.

    Raises:
        ValueError, OSError: the pose model or the video cannot be used.
    """
    with estimator_of(settings) as estimator:
        frames = sum(1 for _ in pictures_of(video))
        chosen = {int(frame) for frame in np.linspace(0, frames - 1, min(count, frames)).round()}
        perceiver = Perceiver(estimator, optics, settings.sensor, video.stem, Counters())
        skeletons = ((picture, perceiver.skeleton(picture)) for picture in pictures_of(video))
        pictures = [_with_joints(*frame, optics) for i, frame in enumerate(skeletons) if i in chosen]
    return pictures, frames


def _with_joints(picture: Picture, skeleton: Skeleton, optics: Optics) -> Pixels:
    """Draw one frame's joints, captioned with its time and how far away each person is."""
    lens = optics.lens_of(picture)
    if lens is None:
        raise ValueError(skeleton.reason)
    distances = ", ".join(f"{_distance_m(agent.joints):.2f} m" for agent in skeleton.agents) or "nobody"
    return drawn(
        optics.unmirrored(picture).image_bgr,
        skeleton.agents,
        lens,
        f"{picture.stamp_ns / SECOND_NS:.2f} s: {distances}",
    )


def _distance_m(joints: list[list[float] | None]) -> float:
    """Return the mean depth (m) of a person's known joints."""
    return float(np.mean([joint[2] for joint in joints if joint is not None]))
