"""Noise of a skeleton tracker, correlated in time and with outliers of the hands; and the sway of standing people."""

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX, JOINTS
from scene_simulator.parameters import NoiseParameters, SwayParameters

HANDS = (INDEX["left_hand"], INDEX["right_hand"])
TONES = 4
"""Sinusoids in each direction of the sway: enough that it does not look periodic."""
UNSURE = 0.5
"""Confidence of a hand during an excursion, when its measured position is wrong."""


class CorrelatedNoise:
    """A first-order autoregressive process of fixed standard deviation, one step per frame."""

    def __init__(self, rng: np.random.Generator, sd: Array, time_constant_s: float, frame_rate_hz: float) -> None:
        self._rng = rng
        self._sd = sd
        self._correlation = float(np.exp(-1 / (time_constant_s * frame_rate_hz)))
        self._value = sd * rng.standard_normal(sd.shape)

    def step(self) -> Array:
        """Return the next value, of the shape of `sd`."""
        fresh = self._sd * self._rng.standard_normal(self._sd.shape)
        self._value = self._correlation * self._value + np.sqrt(1 - self._correlation**2) * fresh
        return self._value


class Excursions:
    """Temporary outliers of one point: an offset in a random direction that follows a raised cosine."""

    def __init__(self, rng: np.random.Generator, parameters: NoiseParameters, frame_rate_hz: float) -> None:
        self._rng = rng
        self._sd_m = parameters.excursion_sd_m
        self._chance = parameters.excursions_per_s / frame_rate_hz
        window = np.hanning(round(parameters.excursion_s * frame_rate_hz) + 2)[1:-1]
        self._window: Array = window / window.max()
        self._frames_left = 0
        self._peak: Array = np.zeros(3)

    def step(self) -> Array | None:
        """Return this frame's offset (3,; m), or None outside of excursions."""
        if self._frames_left == 0 and self._rng.random() < self._chance:
            self._frames_left = len(self._window)
            self._peak = self._sd_m * self._rng.standard_normal(3)
        if self._frames_left == 0:
            return None
        self._frames_left -= 1
        return np.asarray(self._window[self._frames_left] * self._peak)


class SkeletonNoise:
    """Measurement noise of joints, as of a tracker like the Kinect's."""

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
        """Return noisy joints (15, 3; m) for one frame's true ones (15, 3; m), and their confidence (15)."""
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
        self._frequency_hz = rng.uniform(*parameters.frequency_range_hz, size=(3, TONES))
        self._phase = rng.uniform(0, 2 * np.pi, size=(3, TONES))
        sd = np.array([parameters.pelvis_sd_m, parameters.pelvis_sd_m, np.deg2rad(parameters.lean_sd_deg)])
        self._amplitude = sd * np.sqrt(2 / TONES)

    def at(self, time_s: Array) -> Array:
        """Return the sway (T, 3; m, m, rad) at times (T,)."""
        angle = 2 * np.pi * self._frequency_hz * time_s[:, None, None] + self._phase
        return np.asarray(self._amplitude * np.sin(angle).sum(axis=-1))
