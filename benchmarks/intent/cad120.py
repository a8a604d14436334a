"""Reaches among boxed objects, seen by a Kinect: CAD-120 as far as it is at hand, sub-sampled and without depth."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from action_fusion.intent.recent_paths import ARMS
from actum.arrays import Array
from actum.node import SECOND_NS
from actum_model_trainer.foreseeing.takes import Contact, Take

FILE = "lighten_poses.npz"
RATE_HZ = 30
JOINTS = {"right_hand": 12, "left_hand": 11, "right_elbow": 6, "left_elbow": 4, "right_shoulder": 5, "left_shoulder": 3}
"""Their columns, in the order of `ARMS`."""
FOCAL_PX, MIDDLE_PX = 525.0, (320.0, 240.0)
"""The camera of a Kinect v1."""
REACHING, REACHABLE = 0, 0
"""The sub-activity, and the affordance of the object that is reached for."""
WITHIN_M, DEPTHS = 1.0, 21
"""A hand touches nothing further (m) from between the shoulders. On the part of a ray that is so near, an object may
stand at so many places, 0.1 m apart at most."""


class Reach(NamedTuple):
    """T frames of a person who reaches for one of n objects.

    Attributes:
        name: of the reach.
        stamps_ns: (T,), rising.
        arms_m: (T, 6, 3), joints in the order of `ARMS`, in the camera frame.
        rays: (n, 3), where each object is, if it is one metre in front of the camera.
        target: the row of the object that is reached for.
    """

    name: str
    stamps_ns: NDArray[np.int64]
    arms_m: Array
    rays: Array
    target: int

    def as_far_as_hands(self) -> Take:
        """Return a take in which each object is as far from the camera as the hands at the beginning."""
        return self._placed(self.rays[:, None] * self.arms_m[0, :2, 2].mean())

    def anywhere(self) -> Take:
        """Return a take in which each object is at `DEPTHS` places, the ones of the first object first."""
        along = self.rays / np.linalg.norm(self.rays, axis=1, keepdims=True)
        shoulders_m = self.arms_m[0, 4:].mean(axis=0)
        nearest_m = along @ shoulders_m
        half_m = np.sqrt(np.maximum(WITHIN_M**2 - (shoulders_m @ shoulders_m - nearest_m**2), 0.0))
        far_m = nearest_m[:, None] + half_m[:, None] * np.linspace(-1, 1, DEPTHS)
        return self._placed(along[:, None] * far_m[..., None])

    def _placed(self, places_m: Array) -> Take:
        """Return a take with the objects at places (n, places, 3)."""
        paths_m = {k: np.tile(place_m, (len(self.stamps_ns), 1)) for k, place_m in enumerate(places_m.reshape(-1, 3))}
        contact = Contact(int(self.stamps_ns[-1]), 0, self.target, "reach")
        return Take(self.name, self.stamps_ns, self.arms_m, paths_m, [contact])


def reaches(folder: Path) -> Iterator[Reach]:
    """Yield the reaches among two or more objects, whose boxes are those of the first frame."""
    with np.load(folder / FILE, allow_pickle=False) as data:
        arrays = {name: data[name] for name in ("pose_mm", "boxes_rcrc", "frame", "label_affordance")}
        chosen = np.flatnonzero(data["label_subactivity"] == REACHING).tolist()
    for number in chosen:
        reach = _reach({name: array[number] for name, array in arrays.items()}, f"reach {number}")
        if reach is not None:
            yield reach


def _reach(of: Mapping[str, Any], name: str) -> Reach | None:
    seen = of["frame"] >= 0
    boxes = of["boxes_rcrc"][1:, seen]
    affordances = enumerate(of["label_affordance"])
    there = [k for k, affordance in affordances if affordance >= 0 and np.isfinite(boxes[k, 0]).all()]
    targets = [row for row, k in enumerate(there) if of["label_affordance"][k] == REACHABLE]
    if len(there) < 2 or len(targets) != 1 or np.count_nonzero(seen) < 3:
        return None
    arms_m = of["pose_mm"][seen][:, list(JOINTS.values())] / 1000 * [1.0, -1.0, 1.0]
    assert arms_m.shape[1] == len(ARMS)
    stamps_ns = np.round(of["frame"][seen] * SECOND_NS / RATE_HZ).astype(np.int64)
    return Reach(name, stamps_ns, arms_m, np.array([_ray(boxes[k, 0]) for k in there]), targets[0])


def _ray(box_rcrc: Array) -> Array:
    """Return where the middle of a box (row, column, row, column; px) is, if it is one metre in front of the camera."""
    middle_px = np.array([box_rcrc[1] + box_rcrc[3], box_rcrc[0] + box_rcrc[2]]) / 2
    return np.append((middle_px - MIDDLE_PX) / FOCAL_PX, 1.0)
