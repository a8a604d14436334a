"""The actor of a segment: one person's postures as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.intake.stream_samples import Body, PostureSample
from actum.arrays import Array, stacked
from actum.messages import Hand
from actum.skeletons import INDEX


@dataclass(frozen=True)
class Actor:
    """One person's p valid postures, up to the end of a segment.

    `stamps_ns` (p,) count from the segment's start, `ego_from_camera` is (p, 4, 4), `joints_m` (p, 15, 3) egocentric,
    NaN where unknown. `bodies` are the p postures as they were received.
    """

    stamps_ns: Array
    ego_from_camera: Array
    joints_m: Array
    bodies: Sequence[Body]

    def joint_m(self, name: str) -> Array:
        """Return a joint's positions (p, 3), egocentric."""
        return self.joints_m[:, INDEX[name]]

    def hand_m(self, side: Hand) -> Array:
        """Return a hand's positions (p, 3), egocentric."""
        return self.joint_m(f"{side}_hand")

    def to_ego(self, positions_m: Array) -> Array:
        """Map a camera-frame position for each posture (…, p, 3) to that posture's egocentric frame (…, p, 3).

        The terms are added in the order in which `np.einsum` adds three, which takes several times as long.
        """
        x_m, y_m, z_m = (self.ego_from_camera[:, :3, axis] * positions_m[..., axis, None] for axis in range(3))
        in_ego_m: Array = x_m + z_m + y_m + self.ego_from_camera[:, :3, 3]
        return in_ego_m


def actor_of(postures: Sequence[PostureSample], start_ns: int) -> Actor:
    """Stack a person's valid postures; there may be none (p = 0). Stamps count from `start_ns`."""
    stamped = [(sample.stamp_ns - start_ns, sample.body) for sample in postures if sample.body is not None]
    bodies = [body for _, body in stamped]
    return Actor(
        np.array([stamp for stamp, _ in stamped], dtype=np.float64),
        stacked([body.ego_from_camera for body in bodies], 4, 4),
        stacked([body.joints_m for body in bodies], len(INDEX), 3),
        bodies,
    )
