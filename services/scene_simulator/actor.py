"""The actor: body proportions and habits drawn from a seed."""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Array
from actum.messages import Hand
from scene_simulator.parameters import ActorParameters
from scene_simulator.random_streams import draw_normal, draw_normals, random_stream

# Lengths as shares of stature, after Drillis and Contini (1966).
HIP_HEIGHT = 0.53  # floor to hip joints
TRUNK = 0.29  # hips to neck
HEAD = 0.115  # neck to the head's middle
SPINE = 0.14  # hips to the torso joint
SHOULDER_SIDE = 0.108  # from the spine to a shoulder
SHOULDER_DROP = 0.02  # from the neck down to the shoulders
HIP_SIDE = 0.052  # from the spine to a hip joint
UPPER_ARM = 0.186  # shoulder to elbow
FOREARM = 0.200  # elbow to palm
FINGER = 0.055  # palm to the tip of the index finger
EYE = 0.05  # from the head's middle forward to the eyes
FOOT_HEIGHT = 0.04  # floor to the foot joint
KNEE_SHARE = 0.5  # of the way from hip to foot


@dataclass(frozen=True)
class Actor:
    """The proportions and habits of one person.

    Attributes:
        bias_rad: (2,), the constant error of pointing, azimuth and elevation.
        appearance_seed: of clothes, skin and hair.
    """

    height_m: float
    hand: Hand
    heading_rad: float
    stand_off_m: float
    stand_x_m: float
    tempo: float
    lean_rad: float
    twist_gain: float
    elbow_out: float
    arc_scale: float
    noise_scale: float
    bias_rad: Array
    appearance_seed: int

    @property
    def side(self) -> int:
        """+1 where the acting hand is the left one, -1 where it is the right one."""
        return 1 if self.hand == "left" else -1

    @property
    def column(self) -> int:
        """Column of the acting hand in arrays of both hands: 0 is the left one, 1 the right one."""
        return 0 if self.hand == "left" else 1

    @property
    def arm_m(self) -> float:
        """Length of the stretched arm from shoulder to palm."""
        return (UPPER_ARM + FOREARM) * self.height_m

    @property
    def finger_m(self) -> float:
        """Length from the palm to the tip of the stretched index finger."""
        return FINGER * self.height_m


def draw_actor(parameters: ActorParameters, actor_seed: int) -> Actor:
    """Draw a person at random; the same seed always gives the same person."""
    rng = random_stream("actor", actor_seed)
    return Actor(
        height_m=draw_normal(rng, parameters.height_mean_sd_m),
        hand="left" if rng.random() < parameters.left_handed_probability else "right",
        heading_rad=np.deg2rad(draw_normal(rng, (0.0, parameters.heading_sd_deg))),
        stand_off_m=draw_normal(rng, parameters.stand_off_mean_sd_m),
        stand_x_m=draw_normal(rng, (0.0, parameters.stand_x_sd_m)),
        tempo=draw_normal(rng, parameters.tempo_mean_sd),
        lean_rad=np.deg2rad(draw_normal(rng, parameters.lean_mean_sd_deg)),
        twist_gain=draw_normal(rng, parameters.twist_gain_mean_sd),
        elbow_out=draw_normal(rng, parameters.elbow_out_mean_sd),
        arc_scale=draw_normal(rng, parameters.arc_mean_sd),
        noise_scale=draw_normal(rng, parameters.noise_mean_sd),
        bias_rad=np.deg2rad(draw_normals(rng, parameters.pointing_bias_sd_deg, 2)),
        appearance_seed=int(rng.integers(2**31)),
    )
