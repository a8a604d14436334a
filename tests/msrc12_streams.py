"""Made-up streams of MSRC-12: a person lifts an arm again and again, stands still between, and drifts to the side."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import INDEX
from kinect_takes import SOURCE_JOINTS
from people import STANDING

RATE_HZ = 30
PERIOD_S = 4.0
LIFT_S = 2.0
"""How long an arm moves about each action point, in the middle of each period."""


def lifting(repetitions: int, drift_m_s: float = 0.0, aside_m: float = 0.0) -> dict[str, NDArray[np.int64]]:
    """One lift a period: arrays `xyz_mm` (frames, 20, 3), `t_us` (frames,) and `tags_us` (repetitions,)."""
    seconds = np.arange(round(repetitions * PERIOD_S * RATE_HZ)) / RATE_HZ
    phase = (seconds % PERIOD_S - PERIOD_S / 2) / LIFT_S
    up_m = np.where(np.abs(phase) < 0.5, 0.4 * (1 + np.cos(2 * np.pi * phase)), 0.0)
    xyz_m = np.tile(standing_m(), (len(seconds), 1, 1))
    xyz_m[:, SOURCE_JOINTS.index("right_hand"), 1] += up_m
    xyz_m[:, SOURCE_JOINTS.index("right_elbow"), 1] += up_m / 2
    xyz_m[..., 0] += aside_m + drift_m_s * seconds[:, None]
    points_us = np.round((np.arange(repetitions) + 0.5) * PERIOD_S * 1e6)
    return {
        "xyz_mm": np.round(1000 * xyz_m).astype(np.int64),
        "t_us": np.round(1e6 * seconds).astype(np.int64),
        "tags_us": points_us.astype(np.int64),
    }


def standing_m() -> NDArray[np.float64]:
    """A person who stands, (20, 3), in the set's axes: x left, y up."""
    own = {name: STANDING[number] * [-1, -1, 1] for name, number in INDEX.items()}
    others = {"hip_center": (own["left_hip"] + own["right_hip"]) / 2}
    for side in ("left", "right"):
        others |= {f"{side}_wrist": own[f"{side}_hand"], f"{side}_ankle": own[f"{side}_foot"]}
    return np.array([{**own, **others}[name] for name in SOURCE_JOINTS])


def written(folder: Path, streams: dict[str, dict[str, NDArray[np.int64]]], person: int = 1) -> Path:
    path = folder / f"p{person:02d}.npz"
    arrays = {f"{name}.{part}": values for name, parts in streams.items() for part, values in parts.items()}
    np.savez(path, **arrays)  # type: ignore[arg-type]
    return path
