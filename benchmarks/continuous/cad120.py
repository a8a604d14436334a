"""CAD-120's people at work with things: part of the set's videos, of which some frames are known, between interpolated.

The file holds up to 20 frames of each segment, evenly spaced; OpenNI's joints in mm, x left, y up, z forward.
"""

from pathlib import Path

import numpy as np

from actum.arrays import Array
from actum.messages import Agent, Skeleton
from actum.recorder import Recorder
from actum.recording import Recording

FILE = "lighten_poses.npz"
OURS = [0, 1, 2, 3, 4, 11, 5, 6, 12, 7, 8, 13, 9, 10, 14]
"""Our joints in the file's order."""
CAMERA_FROM_THEIRS = np.array([-0.001, -0.001, 0.001])
"""Millimetres, x left and y up, to metres, x right and y down."""
RATE_HZ, STEP = 30, 2
"""Of the videos; every second frame is interpolated."""
LONGEST_GAP = 12
"""Frames between two that are known, beyond which nothing is known between (0.4 s)."""


def import_cad120(folder: Path, out: Path, *_: object) -> None:
    """Write a recording of each video, without labels."""
    with np.load(folder / FILE) as stored:
        video, frame, pose_mm, subject = (stored[name] for name in ("video", "frame", "pose_mm", "subject"))
    for name in sorted(set(video.tolist())):
        known = video == name
        numbers, joints = frame[known].ravel(), pose_mm[known].reshape(-1, 15, 3)
        order = np.argsort(numbers[numbers >= 0], kind="stable")
        rising, first = np.unique(numbers[numbers >= 0][order], return_index=True)
        person = subject[known][0].removeprefix("Subject")
        with Recorder(out / f"{name}.mcap", person=person, source="cad120") as recorder:
            for message in _frames(rising, joints[numbers >= 0][order][first][:, OURS] * CAMERA_FROM_THEIRS, name):
                recorder.write(message)


def _frames(numbers: Array, joints_m: Array, session_id: str) -> list[Skeleton]:
    wanted = np.arange(numbers[0], numbers[-1] + 1, STEP)
    after = np.minimum(np.searchsorted(numbers, wanted), len(numbers) - 1)
    gaps = numbers[after] - numbers[np.maximum(after - 1, 0)]
    rows = joints_m.reshape(len(joints_m), -1)
    between = np.stack([np.interp(wanted, numbers, column) for column in rows.T], axis=1).reshape(-1, 15, 3)
    return [
        Skeleton(
            stamp_ns=int(number) * 1_000_000_000 // RATE_HZ,
            sensor="kinect0",
            agents=[Agent(agent=1, joints=joints.tolist(), confidence=[1.0] * 15)],
            session_id=session_id,
        )
        for number, joints, gap in zip(wanted, between, gaps, strict=True)
        if gap <= LONGEST_GAP
    ]


def cad120_recordings(folder: Path, imported: Path) -> list[Recording]:
    """Return a recording of each video."""
    out = imported / "cad120"
    if not out.exists():
        import_cad120(folder, out)
    return [Recording(path) for path in sorted(out.glob("*.mcap"))]
