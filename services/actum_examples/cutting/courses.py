"""Courses: what one person does without a break, at an even rate."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum import keys
from actum.arrays import Array
from actum.messages import Posture, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.skeletons import JOINTS
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.frames import frame_of
from som_classifier.kinematics import LAG_TIME_CONSTANT_S, KinematicsFilter

RATE_HZ = 15.0
"""Rate of a course: the slowest camera's, and enough for a movement of a third of a second."""
BREAK_S = 5.0
"""A person who is not seen for longer begins another course: whatever was done meanwhile, it was not seen."""
LEAST_FRAMES = 15
"""Frames that a course needs: a second at the slowest camera's rate; less holds no repetition and its rest."""
NOISE_SHARE = 0.2
"""Share of the time in which a joint is taken to be at rest: its speed then is the sensor's noise."""
ABOVE_NOISE = 2.5
"""A joint moves where it is faster than its noise by this factor."""
STILL_S = 1.0
"""Time (s) over which a joint's standing noise is measured: the sensor's jitter, and half a sway."""
SWAY = 2.0
"""A joint's deviation over a minute of standing, as a multiple of that within `STILL_S` at its stillest."""
UNEVEN = 3.0
"""No joint is noisier than the median joint by a larger factor: one that seems so moves most of the time."""
SMOOTHING = np.array([1.0, 3.0, 4.0, 3.0, 1.0]) / 12
"""Weights of neighbouring instants, a third of a second in all: one jump of a joint is no movement."""


@dataclass(frozen=True, eq=False)
class Course:
    """One person's movement without a break, at `RATE_HZ`.

    Attributes:
        agent: the person's number.
        start_ns: stamp of the first of the n instants.
        postures: (n, 15, 3), upright, scaled to the standard body's metres, smoothed; missing joints interpolated.
        speeds_mps: (n,), root mean square over the joints of what exceeds each joint's noise.
        noise_m: (15,), deviation of each joint from its mean while the person stands still.
        distance_m: median distance from the camera; infinite where unknown.
    """

    agent: int
    start_ns: int
    postures: Array
    speeds_mps: Array
    noise_m: Array
    distance_m: float

    def stamp_ns(self, index: float) -> int:
        """Return the stamp at an index, which need not be whole."""
        return self.start_ns + round(index / RATE_HZ * SECOND_NS)


@dataclass(frozen=True, eq=False)
class _Instant:
    """What a course keeps of a frame: stamp, joints (15, 3) with NaN where missing, speeds (15,) in m/s, distance."""

    stamp_ns: int
    joints: NDArray[np.float32]
    speeds_mps: NDArray[np.float32]
    distance_m: float


class PersonTracks:
    """Collects each person's postures from skeletons, as the classifier would get them."""

    def __init__(self) -> None:
        self._preprocessor = PosePreprocessor(PoseSettings.defaults())
        self._filters: dict[int, KinematicsFilter] = {}
        self._instants: dict[int, list[_Instant]] = {}

    def receive(self, skeleton: Skeleton) -> None:
        """Receive the next frame of one sensor."""
        for posture in self._preprocessor.handle(skeleton):
            if not isinstance(posture, Posture) or not posture.agent:
                continue
            frame = frame_of(posture, 0, self._filters.setdefault(posture.agent, KinematicsFilter()))
            if frame.kinematics is not None:
                speeds_mps = np.linalg.norm(frame.kinematics.velocity, axis=1) / LAG_TIME_CONSTANT_S
                joints = frame.kinematics.posture.astype(np.float32)
                instant = _Instant(frame.stamp_ns, joints, speeds_mps.astype(np.float32), frame.distance_m)
                self._instants.setdefault(posture.agent, []).append(instant)

    def courses(self) -> list[Course]:
        """Return the courses so far, by person, those of one person in order."""
        return [
            _course(agent, unbroken)
            for agent, instants in sorted(self._instants.items())
            for unbroken in _without_breaks(instants)
            if len(unbroken) >= LEAST_FRAMES
        ]


def recorded_courses(recording: Recording, sensor: str) -> list[Course]:
    """Return the courses of all people whom one sensor of a recording saw.

    Raises:
        RecordingError: the file is damaged.
    """
    tracks = PersonTracks()
    for message in recording.messages((keys.SKELETON,)):
        if isinstance(message, Skeleton) and message.sensor == sensor:
            tracks.receive(message)
    return tracks.courses()


def course_of(agent: int, stamps_ns: Sequence[int], joints: Array, speeds_mps: Array, distance_m: float) -> Course:
    """Bring a person's frames to an even rate.

    Args:
        agent: the person's number.
        stamps_ns: (m,), rising.
        joints: (m, 15, 3), NaN where missing.
        speeds_mps: (m, 15), NaN where missing.
        distance_m: from the camera.
    """
    times_s = (np.asarray(stamps_ns) - stamps_ns[0]) / SECOND_NS
    even_s = np.arange(int(times_s[-1] * RATE_HZ + 1e-6) + 1) / RATE_HZ
    postures = _resampled(times_s, joints.reshape(len(joints), -1), even_s).reshape(-1, len(JOINTS), 3)
    speeds = smoothed(_resampled(times_s, speeds_mps, even_s))
    noise = ABOVE_NOISE * _noise(speeds)
    moving = np.sqrt(np.maximum(speeds**2 - noise**2, 0).mean(axis=1))
    return Course(agent, stamps_ns[0], postures, moving, SWAY * _noise(_deviations_m(postures)), distance_m)


def averaged(values: Array, seconds: float) -> Array:
    """Average values (n, ...) over the time about each instant."""
    return _weighted(values, np.full(2 * round(seconds * RATE_HZ / 2) + 1, 1.0))


def smoothed(values: Array) -> Array:
    """Average values (n, ...) with their neighbours."""
    return _weighted(values, SMOOTHING)


def _weighted(values: Array, weights: Array) -> Array:
    reach = len(weights) // 2
    padded = np.pad(values, [(reach, reach), *[(0, 0)] * (values.ndim - 1)], mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, len(weights), axis=0)
    mean: Array = windows @ (weights / weights.sum())
    return mean


def _noise(values: Array) -> Array:
    """Return each joint's value (15,) while the person stands still, from those of all instants (n, 15)."""
    still = np.quantile(values, NOISE_SHARE, axis=0)
    evened: Array = np.minimum(still, UNEVEN * np.median(still))
    return evened


def _deviations_m(postures: Array) -> Array:
    """Return how far each joint deviates from its mean in the time about each instant, shape (n, 15)."""
    size = min(round(STILL_S * RATE_HZ), len(postures))
    windows = np.lib.stride_tricks.sliding_window_view(postures, size, axis=0)
    deviations: Array = np.sqrt(windows.var(axis=3).sum(axis=2))
    return deviations


def _course(agent: int, instants: Sequence[_Instant]) -> Course:
    return course_of(
        agent,
        [instant.stamp_ns for instant in instants],
        np.array([instant.joints for instant in instants], dtype=np.float64),
        np.array([instant.speeds_mps for instant in instants], dtype=np.float64),
        float(np.median([instant.distance_m for instant in instants])),
    )


def _resampled(times_s: Array, values: Array, even_s: Array) -> Array:
    """Interpolate columns (m, c), NaN where unknown, at even times (n,). A column that is never known is zero."""
    resampled = np.zeros((len(even_s), values.shape[1]))
    for column in range(values.shape[1]):
        known = ~np.isnan(values[:, column])
        if known.any():
            resampled[:, column] = np.interp(even_s, times_s[known], values[known, column])
    return resampled


def _without_breaks(instants: Iterable[_Instant]) -> Iterator[list[_Instant]]:
    """Yield the runs of frames between which the person is seen; a clock that begins anew ends a run, too."""
    run: list[_Instant] = []
    for instant in instants:
        if run and not 0 < instant.stamp_ns - run[-1].stamp_ns <= BREAK_S * SECOND_NS:
            yield run
            run = []
        run.append(instant)
    if run:
        yield run
