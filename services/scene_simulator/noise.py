"""The skeleton tracker's noise: correlated in time, with a hand lost now and then; and the sway of standing."""

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX, JOINTS
from scene_simulator.parameters import NoiseParameters, SwayParameters

HANDS = (INDEX["left_hand"], INDEX["right_hand"])
UNSURE = 0.5


class CorrelatedNoise:
    """A first-order autoregressive process of fixed standard deviation, one step per frame."""

    def __init__(self, rng: np.random.Generator, sd: Array, time_constant_s: float, frame_rate_hz: float) -> None:
        self._rng = rng
        self._sd = sd
        self._keep = float(np.exp(-1 / (time_constant_s * frame_rate_hz)))
        self._value = sd * rng.standard_normal(sd.shape)

    def step(self) -> Array:
        """Return the next value, of the shape of `sd`."""
        fresh = self._sd * self._rng.standard_normal(self._sd.shape)
        self._value = self._keep * self._value + np.sqrt(1 - self._keep**2) * fresh
        return self._value


class Excursions:
    """Moments in which one point is seen far off: a raised cosine in a random direction."""

    def __init__(self, rng: np.random.Generator, parameters: NoiseParameters, frame_rate_hz: float) -> None:
        self._rng = rng
        self._sd_m = parameters.excursion_sd_m
        self._chance = parameters.excursions_per_s / frame_rate_hz
        window = np.hanning(round(parameters.excursion_s * frame_rate_hz) + 2)[1:-1]
        self._window: Array = window / window.max()
        self._left = 0
        self._peak: Array = np.zeros(3)

    def step(self) -> Array | None:
        """Return this frame's offset (3,), or None while the point is seen well."""
        if self._left == 0 and self._rng.random() < self._chance:
            self._left = len(self._window)
            self._peak = self._sd_m * self._rng.standard_normal(3)
        if self._left == 0:
            return None
        self._left -= 1
        return np.asarray(self._window[self._left] * self._peak)


class SkeletonNoise:
    """What a Kinect-like tracker makes of true joints."""

    def __init__(
        self, rng: np.random.Generator, parameters: NoiseParameters, scale: float, frame_rate_hz: float
    ) -> None:
        kinds = [parameters.joint_sd_m[name.rsplit("_", 1)[-1]] for name in JOINTS]
        sd = scale * np.array(kinds)[:, None] * np.ones(3)
        common_sd = np.full(3, scale * parameters.common_sd_m)
        self._joints = CorrelatedNoise(rng, sd, parameters.time_constant_s, frame_rate_hz)
        self._common = CorrelatedNoise(rng, common_sd, parameters.time_constant_s, frame_rate_hz)
        self._excursions = [Excursions(rng, parameters, frame_rate_hz) for _ in HANDS]

    def measure(self, joints_m: Array) -> tuple[Array, list[float]]:
        """Return one frame's measured joints (15, 3) and the tracker's confidence in each."""
        measured = joints_m + self._joints.step() + self._common.step()
        confidence = [1.0] * len(JOINTS)
        for hand, excursion in zip(HANDS, self._excursions, strict=True):
            offset = excursion.step()
            if offset is not None:
                measured[hand] += offset
                confidence[hand] = UNSURE
        return measured, confidence


class Sway:
    """Slow sway as a sum of sinusoids: pelvis forward and sideways (m), trunk lean (rad)."""

    def __init__(self, rng: np.random.Generator, parameters: SwayParameters) -> None:
        tones = 4
        self._frequency_hz = rng.uniform(*parameters.frequency_range_hz, size=(3, tones))
        self._phase = rng.uniform(0, 2 * np.pi, size=(3, tones))
        sd = np.array([parameters.pelvis_sd_m, parameters.pelvis_sd_m, np.deg2rad(parameters.lean_sd_deg)])
        self._amplitude = sd * np.sqrt(2 / tones)

    def at(self, time_s: Array) -> Array:
        """Return the sway (T, 3) at the given times."""
        angle = 2 * np.pi * self._frequency_hz * time_s[:, None, None] + self._phase
        return np.asarray(self._amplitude * np.sin(angle).sum(axis=-1))
