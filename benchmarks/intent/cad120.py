"""Reaches among boxed objects, seen by a Kinect: CAD-120 as far as it is at hand, sub-sampled and without depth."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from action_fusion.intent.contact_network import shipped_network
from action_fusion.intent.recent_paths import ARMS
from actum.arrays import Array
from actum.node import SECOND_NS
from actum_model_trainer.foreseeing import baselines
from actum_model_trainer.foreseeing.said import seen_in
from actum_model_trainer.foreseeing.takes import Contact, Take

FILE = "lighten_poses.npz"
RATE_HZ = 30
JOINTS = {"right_hand": 12, "left_hand": 11, "right_elbow": 6, "left_elbow": 4, "right_shoulder": 5, "left_shoulder": 3}
"""Their columns, in the order of `ARMS`."""
FOCAL_PX, MIDDLE_PX = 525.0, (320.0, 240.0)
"""The camera of a Kinect v1."""
REACHING, REACHABLE = 0, 0
"""The sub-activity, and the affordance of the object that is reached for."""
SHARES = (0.5, 0.8)
"""Shares of the reach that have been seen."""


def reaches(folder: Path) -> Iterator[Take]:
    """Yield the reaches among two or more objects, each object on the ray through its box, as far away as the hands.

    How far an object is nobody knows; the boxes are those of the first frame.
    """
    with np.load(folder / FILE, allow_pickle=False) as data:
        arrays = {name: data[name] for name in ("pose_mm", "boxes_rcrc", "frame", "label_affordance")}
        chosen = np.flatnonzero(data["label_subactivity"] == REACHING).tolist()
    for number in chosen:
        take = _reach({name: array[number] for name, array in arrays.items()}, f"reach {number}")
        if take is not None:
            yield take


def _reach(of: Mapping[str, Any], name: str) -> Take | None:
    seen = of["frame"] >= 0
    boxes = of["boxes_rcrc"][1:, seen]
    there = [
        k for k, affordance in enumerate(of["label_affordance"]) if affordance >= 0 and np.isfinite(boxes[k, 0]).all()
    ]
    targets = [k for k in there if of["label_affordance"][k] == REACHABLE]
    if len(there) < 2 or len(targets) != 1 or np.count_nonzero(seen) < 3:
        return None
    joints_m = of["pose_mm"][seen][:, list(JOINTS.values())] / 1000 * [1.0, -1.0, 1.0]
    stamps_ns = np.round(of["frame"][seen] * SECOND_NS / RATE_HZ).astype(np.int64)
    depth_m = float(joints_m[0, :2, 2].mean())
    places = {k: np.tile(_on_ray(boxes[k, 0], depth_m), (len(stamps_ns), 1)) for k in there}
    assert joints_m.shape[1] == len(ARMS)
    return Take(name, stamps_ns, joints_m, places, [Contact(int(stamps_ns[-1]), 0, targets[0], "reach")])


def _on_ray(box_rcrc: Array, depth_m: float) -> Array:
    """Return the point of the ray through the middle of a box (row, column, row, column; px) at a depth."""
    middle_px = np.array([box_rcrc[1] + box_rcrc[3], box_rcrc[0] + box_rcrc[2]]) / 2
    return np.append((middle_px - MIDDLE_PX) / FOCAL_PX, 1.0) * depth_m


def table(folder: Path) -> Iterator[str]:
    """Yield how often the likeliest object is the one that is reached for."""
    takes, network = list(reaches(folder)), shipped_network()

    def ours(take: Take) -> Array:
        return np.array([network.foresee(*each).probability.sum(axis=0) for each in zip(*seen_in(take), strict=True)])

    methods = {"actum": ours, "nearest object": baselines.nearest, "constant velocity": baselines.constant_velocity}
    chance = float(np.mean([1 / len(take.objects_m) for take in takes]))
    yield (
        f"{len(takes)} reaches of four people among two or more objects. Objects are known by their boxes in the image "
        "alone: each counts as being on the ray through its box, as far from the camera as the hands at the beginning. "
        f"By chance {chance:.2f} would be right."
    )
    rows = [
        f"| {name} | {' | '.join(f'{_right(takes, method, share):.2f}' for share in SHARES)} |"
        for name, method in methods.items()
    ]
    head = "| | " + " | ".join(f"right after {share:.0%} of the reach" for share in SHARES) + " |\n|---|---:|---:|"
    yield "\n".join([head, *rows])


def _right(takes: list[Take], method: baselines.Method, share: float) -> float:
    right = []
    for take in takes:
        row = round(share * (len(take.stamps_ns) - 1))
        scores = method(take)[row]
        right.append(
            np.isfinite(scores.max()) and sorted(take.objects_m)[int(scores.argmax())] == take.contacts[0].number
        )
    return float(np.mean(right))
