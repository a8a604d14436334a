"""One take of a public data set of skeletons, and functions that the readers of all such sets share."""

import json
import warnings
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.messages import Agent, Segment, Skeleton
from actum.node import SECOND_NS
from actum.recording import ACTION_POINTS
from actum.skeletons import JOINTS, to_actum


class DatasetError(ValueError):
    """A file or folder that is not of the data set's form; the text names it, the problem and what to do."""


@dataclass(frozen=True)
class Take:
    """One recorded file: its frames, and its labelled segments as start and end marks.

    Attributes:
        metadata: written into the recording beside person and source.
        oddities: counts of what was dropped or unusual in the file, by kind.
        skipped: names of the segments that could not be marked.
    """

    name: str
    person: str
    frames: list[Skeleton]
    marks: list[Segment] = field(default_factory=list)
    metadata: dict[str, str] = field(default_factory=dict)
    oddities: Counter[str] = field(default_factory=Counter)
    skipped: list[str] = field(default_factory=list)

    def set_action_points(self, points_ns: Mapping[str, int]) -> None:
        """Write annotated action points (ns) by segment id into the metadata."""
        self.metadata[ACTION_POINTS] = json.dumps(points_ns)


def files_of(path: Path, pattern: str) -> list[Path]:
    """Return the file itself, or the folder's files of that pattern in order of name.

    Raises:
        DatasetError: there is none.
    """
    files = [path] if path.is_file() else sorted(path.glob(pattern))
    if not files:
        raise DatasetError(
            f"{path} contains no file named {pattern}: give a file of such a name, or a folder that contains such files"
        )
    return files


def read_rows(path: Path, columns: int) -> NDArray[np.float64]:
    """Read a text file of finite numbers (rows, columns).

    Raises:
        DatasetError: the file holds anything else.
    """
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")
            rows = np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise DatasetError(
            f"{path} does not consist of rows of {columns} numbers ({error}): download the file again"
        ) from None
    if rows.shape[0] == 0 or rows.shape[1] != columns or not np.isfinite(rows).all():
        raise DatasetError(f"{path} does not consist of rows of {columns} finite numbers: download the file again")
    return rows


def frame_without_person(stamp_ns: int, sensor: str, session_id: str) -> Skeleton:
    """Return an invalid skeleton message, for a frame in which the set has no skeleton."""
    reason = "no skeleton in the source"
    return Skeleton(stamp_ns=stamp_ns, sensor=sensor, valid=False, reason=reason, agents=[], session_id=session_id)


def frame_of_person(
    stamp_ns: int, joints_m: NDArray[np.float64], sensor: str, session_id: str, skeleton: str = "kinect-v1-20"
) -> Skeleton:
    """Return the frame of one person.

    Args:
        stamp_ns: of the frame.
        joints_m: (20, 3), x left, y up, z forward; or (20, 4) with the confidence of each joint, which is otherwise 1.
        sensor: the sensor's name.
        session_id: of the recording.
        skeleton: the map from the set's joints to ours, by its name in `SKELETON_MAPS`.
    """
    own = np.array(to_actum(joints_m.tolist(), skeleton))
    confidence = own[:, 3].tolist() if own.shape[1] > 3 else [1.0] * len(JOINTS)
    agent = Agent(agent=1, joints=(own[:, :3] * [-1.0, -1.0, 1.0]).tolist(), confidence=confidence)
    return Skeleton(stamp_ns=stamp_ns, sensor=sensor, agents=[agent], session_id=session_id)


def stamp_of(index: int, rate_hz: int) -> int:
    """Return the stamp (ns, rounded) of a frame by its index, at a fixed rate."""
    return (2 * index * SECOND_NS + rate_hz) // (2 * rate_hz)
