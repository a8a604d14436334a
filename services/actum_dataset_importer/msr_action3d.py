"""MSR Action3D: one pre-segmented action per text file, twenty joints at 15 frames/s, metres, x left and y up.

Rows are `x y z confidence`, twenty a frame (Li, Zhang, Liu 2010). Files are named `a01_s01_e01_skeleton3D.txt`:
action, person, execution.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.messages import Skeleton, segment_marks
from actum_dataset_importer.takes import (
    DatasetError,
    Take,
    files_of,
    frame_of_person,
    frame_without_person,
    read_rows,
    stamp_of,
)

FRAMES_PER_SECOND = 15
"""As the set's paper says; its files hold no times."""
SOURCE_JOINTS = 20
"""Joints of Kinect's skeleton, of which fifteen are kept."""
PATTERN = "*_skeleton3D.txt"
NAME = re.compile(r"(a(?P<action>\d\d)_s(?P<person>\d\d)_e(?P<execution>\d\d))_skeleton3D\.txt")

CLASSES: tuple[str, ...] = (
    "high arm wave",
    "horizontal arm wave",
    "hammer",
    "hand catch",
    "forward punch",
    "high throw",
    "draw x",
    "draw tick",
    "draw circle",
    "hand clap",
    "two hand wave",
    "side boxing",
    "bend",
    "forward kick",
    "side kick",
    "jogging",
    "tennis swing",
    "tennis serve",
    "golf swing",
    "pickup & throw",
)
"""Names of the actions a01 … a20."""

EXCLUDED = frozenset(
    {
        "a02_s03_e02",
        "a04_s03_e01",
        "a07_s04_e01",
        "a13_s09_e01",
        "a13_s09_e02",
        "a13_s09_e03",
        "a14_s03_e01",
        "a20_s07_e01",
        "a20_s07_e03",
        "a20_s10_e03",
    }
)
"""The sequences that the usual protocol of 557 leaves out."""


def sequence_files(path: Path) -> list[Path]:
    """List the sequence files of the set's folder or of its `real3d`.

    Raises:
        DatasetError: there is none.
    """
    return files_of(path / "real3d" if (path / "real3d").is_dir() else path, PATTERN)


def read_sequence(path: Path, sensor: str) -> Take:
    """Read one sequence, all of it one labelled segment.

    A frame of zeros had no skeleton and becomes an invalid frame.

    Raises:
        DatasetError: the name or the content is not of the set's form.
    """
    match = NAME.fullmatch(path.name)
    if match is None or not 1 <= int(match["action"]) <= len(CLASSES):
        raise DatasetError(f"{path} is not named like a01_s01_e01_skeleton3D.txt: keep the data set's own file names")
    name = match[1]
    frames = [_skeleton(i, rows, sensor, name) for i, rows in enumerate(_frames(path))]
    metadata = {"action": f"a{match['action']}", "execution": str(int(match["execution"]))}
    if name in EXCLUDED:
        metadata["excluded"] = "true"
    label = CLASSES[int(match["action"]) - 1]
    marks = segment_marks(frames[0].stamp_ns, frames[-1].stamp_ns, sensor, name, label)
    return Take(name, str(int(match["person"])), frames, marks, metadata)


def _frames(path: Path) -> NDArray[np.float64]:
    """Read the frames (frames, 20, 4): x, y, z (m), confidence."""
    rows = read_rows(path, columns=4)
    if len(rows) % SOURCE_JOINTS:
        raise DatasetError(
            f"{path} has {len(rows)} rows; expected a multiple of {SOURCE_JOINTS}, one row for each joint in each "
            "frame: download the file again"
        )
    return rows.reshape(-1, SOURCE_JOINTS, 4)


def _skeleton(i: int, rows: NDArray[np.float64], sensor: str, session_id: str) -> Skeleton:
    stamp_ns = stamp_of(i, FRAMES_PER_SECOND)
    if not rows.any():
        return frame_without_person(stamp_ns, sensor, session_id)
    return frame_of_person(stamp_ns, rows, sensor, session_id, "msr-action3d-20")
