"""The people of one image after another as agents: found, placed, told apart, low-passed."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from actum.messages import Agent, Joint
from actum.skeletons import INDEX
from sensor_gateway.camera.landmarks import Landmarks
from sensor_gateway.camera.one_euro import OneEuro
from sensor_gateway.camera.people import People
from sensor_gateway.camera.placing import Placed, PlacingError

Image = NDArray[np.uint8]
TRUNK = frozenset({INDEX["neck"], INDEX["torso"]})
LEAST_CONFIDENCE = 0.1
SAME_PERSON = 0.12


class Estimator(Protocol):
    """What finds people in an image."""

    def people(self, image_bgr: Image, stamp_ns: int) -> list[Landmarks]:
        """Return those seen in an image of shape (height, width, 3)."""
        ...


class Nobody:
    """An estimator where people come from elsewhere."""

    def people(self, image_bgr: Image, stamp_ns: int) -> list[Landmarks]:
        """Return nobody."""
        return []


class Bodies:
    """Turns images into agents; `place` puts one person's landmarks into the camera frame."""

    def __init__(self, estimator: Estimator) -> None:
        self._estimator = estimator
        self._people = People()
        self._filters: dict[int, OneEuro] = {}

    def agents(self, image_bgr: Image, stamp_ns: int, place: Callable[[Landmarks], Placed]) -> list[Agent]:
        """Return the agents of one image; stamps rise."""
        found = distinct(self._estimator.people(image_bgr, stamp_ns))
        bodies = [body for body in (_in_front(marks, place) for marks in found) if body is not None]
        numbers = self._people.step(stamp_ns, [body.joints_m[INDEX["torso"]] for body in bodies])
        self._filters = {n: low_pass for n, low_pass in self._filters.items() if n in self._people.expected}
        return [self._agent(number, body, stamp_ns) for number, body in zip(numbers, bodies, strict=True)]

    def _agent(self, number: int, body: Placed, stamp_ns: int) -> Agent:
        joints_m = self._filters.setdefault(number, OneEuro()).step(stamp_ns, body.joints_m)
        joints: list[Joint] = [
            joint if confidence >= LEAST_CONFIDENCE or i in TRUNK else None
            for i, (joint, confidence) in enumerate(zip(joints_m.tolist(), body.confidence, strict=True))
        ]
        std_m = None if body.depth_std_m is None else round(body.depth_std_m, 3)
        return Agent(agent=number, joints=joints, confidence=body.confidence.tolist(), depth_std_m=std_m)


def distinct(found: Sequence[Landmarks]) -> list[Landmarks]:
    """Leave out those that lie upon somebody else: the model sometimes finds one person twice."""
    kept: list[Landmarks] = []
    for marks in sorted(found, key=lambda marks: -float(marks.visibility.sum())):
        if all(_apart(marks, other) > SAME_PERSON for other in kept):
            kept.append(marks)
    return kept


def _apart(one: Landmarks, other: Landmarks) -> float:
    """Return how far apart two persons' landmarks lie, the median as a share of the larger one's spread."""
    spread = max(float(np.ptp(marks.image_px[:, 1])) for marks in (one, other))
    return float(np.median(np.linalg.norm(one.image_px - other.image_px, axis=1))) / max(spread, 1.0)


def _in_front(marks: Landmarks, place: Callable[[Landmarks], Placed]) -> Placed | None:
    try:
        return place(marks)
    except PlacingError:
        return None
