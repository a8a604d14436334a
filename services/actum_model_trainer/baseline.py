"""The baseline: one nearest neighbour on the raw path of the hand.

A path is the position of the hand relative to the torso, in camera axes and metres as measured: without scaling,
egocentric frame or map. Of the two hands, the one with the longer path is taken. The frames of a segment that have
torso and both hands are resampled, linearly in time, to 32 instants at equal intervals. The answer is the label of
the training path with the smallest Euclidean distance over these 96 numbers.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum import keys
from actum.arrays import Array
from actum.messages import Agent, Skeleton, is_action
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_model_trainer.evaluation import Evaluation, Prediction
from actum_model_trainer.recorded_segments import classifier_input, closed_segments, sensors
from som_classifier.segments import ClosedSegment

POINTS = 32  # per path: about one a frame for an action of a second
_JOINTS = [INDEX["left_hand"], INDEX["right_hand"], INDEX["torso"]]


@dataclass(frozen=True, eq=False)
class HandPath:
    """The hand path of a labelled segment.

    Attributes:
        points_m: (32, 3), relative to the torso in camera axes; None where fewer than two frames have the joints.
    """

    file: str
    segment_id: str
    label: str
    points_m: Array | None


def nearest_neighbour(training: Sequence[Recording], test: Sequence[Recording]) -> Evaluation:
    """Answer each labelled segment of the test recordings with the label of the nearest training path.

    Raises:
        ValueError: the training recordings hold no path.
    """
    labelled_paths = [(path.label, path.points_m) for path in hand_paths(training) if path.points_m is not None]
    if not labelled_paths:
        raise ValueError(
            "no labelled segment of the training recordings shows both hands and the torso in at least two frames: "
            "give other training recordings"
        )
    labels = [label for label, _ in labelled_paths]
    points_m = np.stack([points for _, points in labelled_paths])
    predictions = []
    for path in hand_paths(test):
        distances2 = None if path.points_m is None else np.square(points_m - path.points_m).sum(axis=(1, 2))
        nearest = None if distances2 is None else labels[int(np.argmin(distances2))]
        predictions.append(Prediction(path.file, path.segment_id, path.label, nearest))
    return Evaluation(tuple(predictions))


def hand_paths(recordings: Sequence[Recording]) -> Iterator[HandPath]:
    """Yield the hand path of every labelled segment."""
    for recording in recordings:
        for sensor in sensors(recording):
            skeletons = [m for m in recording.messages((keys.SKELETON,)) if isinstance(m, Skeleton)]
            of_sensor = [skeleton for skeleton in skeletons if skeleton.sensor == sensor]
            for closed in closed_segments(classifier_input(recording, sensor)):
                if is_action(closed.label):
                    yield HandPath(str(recording.path), closed.segment_id, closed.label, _path(of_sensor, closed))


def hand_path(hands_and_torso_m: Array, stamps_ns: NDArray[np.int64]) -> Array:
    """Return the longer of the two hands' paths relative to the torso, at 32 instants, shape (32, 3), metres.

    Args:
        hands_and_torso_m: (n, 3, 3), in each frame of the segment the left hand, the right hand and the torso, all in
            the same coordinate frame.
        stamps_ns: (n,), rising.
    """
    hands_m = hands_and_torso_m[:, :2] - hands_and_torso_m[:, 2:]
    lengths_m = np.linalg.norm(np.diff(hands_m, axis=0), axis=2).sum(axis=0)
    path_m = hands_m[:, int(np.argmax(lengths_m))]
    elapsed_ns = (stamps_ns - stamps_ns[0]).astype(np.float64)
    wanted_ns = np.linspace(0.0, elapsed_ns[-1], POINTS)
    return np.stack([np.interp(wanted_ns, elapsed_ns, axis) for axis in path_m.T], axis=1)


def _path(skeletons: Sequence[Skeleton], closed: ClosedSegment) -> Array | None:
    frames = [
        (skeleton.stamp_ns, points)
        for skeleton in skeletons
        if closed.start_ns <= skeleton.stamp_ns <= closed.end_ns
        for agent in skeleton.agents
        if agent.agent == closed.agent and (points := _hands_and_torso(agent)) is not None
    ]
    if len(frames) < 2:
        return None
    return hand_path(np.stack([points for _, points in frames]), np.array([stamp_ns for stamp_ns, _ in frames]))


def _hands_and_torso(agent: Agent) -> Array | None:
    points = [agent.joints[joint] for joint in _JOINTS]
    if None in points or not np.isfinite(array := np.array(points, dtype=np.float64)).all():
        return None
    return array
