"""Tracks the people in successive images as agents: detects, places, identifies and smooths them."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from actum.filters import OneEuro
from actum.messages import Agent
from actum.skeletons import INDEX
from sensor_gateway.known_joints import known_joints
from sensor_gateway.people.identities import Identities
from sensor_gateway.people.landmarks import Estimator, Landmarks
from sensor_gateway.people.placing import Placed, PlacingError

SAME_PERSON = 0.12
"""Largest median distance between two detections' landmarks of one person, in heights of the larger detection."""


class PeopleTracker:
    """Turns images into agents, with a one-euro filter for each person."""

    def __init__(self, estimator: Estimator) -> None:
        self._estimator = estimator
        self._identities = Identities()
        self._filters: dict[int, OneEuro] = {}

    def agents(self, image_bgr: NDArray[np.uint8], stamp_ns: int, place: Callable[[Landmarks], Placed]) -> list[Agent]:
        """Return the agents of one image (height, width, 3); stamps rise.

        `place` places one person's landmarks in the camera frame; a detection is dropped if it raises `PlacingError`.
        """
        detections = distinct(self._estimator.people(image_bgr, stamp_ns))
        people = [person for person in (_placed(landmarks, place) for landmarks in detections) if person is not None]
        numbers = self._identities.step(stamp_ns, [person.joints_m[INDEX["torso"]] for person in people])
        self._filters = {n: filter_ for n, filter_ in self._filters.items() if n in self._identities.expected}
        return [self._agent(number, person, stamp_ns) for number, person in zip(numbers, people, strict=True)]

    def _agent(self, number: int, person: Placed, stamp_ns: int) -> Agent:
        joints_m = self._filters.setdefault(number, OneEuro()).step(stamp_ns, person.joints_m).tolist()
        confidence = person.confidence.tolist()
        std_m = None if person.depth_std_m is None else round(person.depth_std_m, 3)
        return Agent(agent=number, joints=known_joints(joints_m, confidence), confidence=confidence, depth_std_m=std_m)


def distinct(detections: Sequence[Landmarks]) -> list[Landmarks]:
    """Drop detections that coincide with a more visible one: the model sometimes detects one person twice."""
    kept: list[Landmarks] = []
    for landmarks in sorted(detections, key=lambda landmarks: -float(landmarks.visibility.sum())):
        if all(_distance(landmarks, other) > SAME_PERSON for other in kept):
            kept.append(landmarks)
    return kept


def _distance(one: Landmarks, other: Landmarks) -> float:
    """Return the median distance of two detections' landmarks, as a share of the larger one's height."""
    height_px = max(float(np.ptp(landmarks.image_px[:, 1])) for landmarks in (one, other))
    return float(np.median(np.linalg.norm(one.image_px - other.image_px, axis=1))) / max(height_px, 1.0)


def _placed(landmarks: Landmarks, place: Callable[[Landmarks], Placed]) -> Placed | None:
    try:
        return place(landmarks)
    except PlacingError:
        return None
