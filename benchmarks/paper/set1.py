"""The 276 sequences on which the paper's first author evaluates her system, turned into recordings.

They are ten actions of MSR Action3D as screen skeletons: `a01_s01_e01.txt` holds a frame a line, twenty joints of
column, row (pixels of a 320 × 240 depth image), depth (4 mm) and confidence. Absurd depths, near 2³¹, are left to the
preprocessor, which takes them for missing.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.messages import Skeleton, segment_marks
from actum_dataset_importer.importing import ImportReport, Progress, import_takes
from actum_dataset_importer.msr_action3d import CLASSES, FRAMES_PER_SECOND, SOURCE_JOINTS
from actum_dataset_importer.takes import (
    DatasetError,
    Take,
    files_of,
    frame_of_person,
    frame_without_person,
    read_rows,
    stamp_of,
)

Array = NDArray[np.float64]

SENSOR = "kinect0"
NAME = re.compile(r"(a(?P<action>\d\d)_s(?P<person>\d\d)_e\d\d)\.txt")
FOCAL_PX = 285.63
"""Nominal, of a Kinect's depth camera at 320 × 240."""
CENTRE_PX = (160.0, 120.0)
DEPTH_M = 0.004


def import_set1(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per sequence, `out/a01_s01_e01.mcap`.

    Raises:
        DatasetError: `src` does not hold the set, or a file of it is damaged.
    """
    files = files_of(src, "a??_s??_e??.txt")
    return import_takes("gharaee-set1", map(read_sequence, files), len(files), out, progress)


def read_sequence(path: Path) -> Take:
    """Read one sequence: the whole of it is one labelled segment.

    Raises:
        DatasetError: the name or the content is not of the set's form.
    """
    match = NAME.fullmatch(path.name)
    if match is None or not 1 <= int(match["action"]) <= len(CLASSES):
        raise DatasetError(f"{path}: not named like a01_s01_e01.txt; keep the set's own file names")
    screen = read_rows(path, columns=4 * SOURCE_JOINTS).reshape(-1, SOURCE_JOINTS, 4)
    frames = [_skeleton(stamp_of(i, FRAMES_PER_SECOND), rows, match[1]) for i, rows in enumerate(screen)]
    label = CLASSES[int(match["action"]) - 1]
    marks = segment_marks(frames[0].stamp_ns, frames[-1].stamp_ns, SENSOR, match[1], label)
    return Take(match[1], str(int(match["person"])), frames, marks)


def positions_m(screen: Array) -> Array:
    """Turn column, row and depth into metres left, up and forward of the camera, as the set has them, shape (n, 3)."""
    forward_m = DEPTH_M * screen[:, 2]
    across = (screen[:, :2] - CENTRE_PX) / FOCAL_PX
    return np.stack([across[:, 0] * forward_m, -across[:, 1] * forward_m, forward_m], axis=1)


def _skeleton(stamp_ns: int, rows: Array, name: str) -> Skeleton:
    if not rows.any():
        return frame_without_person(stamp_ns, SENSOR, name)
    joints_m = np.column_stack([positions_m(rows), rows[:, 3]])
    return frame_of_person(stamp_ns, joints_m, SENSOR, name, "msr-action3d-20")
