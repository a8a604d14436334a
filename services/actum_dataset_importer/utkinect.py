"""UTKinect-Action3D: continuous recordings, twenty joints, metres, x left and y up, with labelled segments.

Rows are an image's number and 60 coordinates (Xia, Chen, Aggarwal 2012), at most 15 a second with numbers that count
at 30. Files are named `joints_s01_e01.txt`: person, execution. Labels lie in one file for all recordings.
"""

import re
from collections import Counter
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from actum.messages import Segment, segment_marks
from actum_dataset_importer.takes import DatasetError, Take, files_of, frame_of_person, read_rows, stamp_of

IMAGES_PER_SECOND = 30
"""The camera's rate (Hz); image numbers count at this rate."""
SOURCE_JOINTS = 20
"""Joints of Kinect's skeleton, of which fifteen are kept."""
PATTERN = "joints_s*_e*.txt"
NAME = re.compile(r"joints_(s(?P<person>\d\d)_e(?P<execution>\d\d))\.txt")
LABELS = "actionLabel_modified.txt"
ORIGINAL_LABELS = "actionLabel.txt"
HEADING = re.compile(r"s\d\d_e\d\d")
LABEL = re.compile(r"(?P<label>\w+)\s*:\s*(?P<start>\d+|NaN)\s+(?P<end>\d+|NaN)")

DUPLICATE_ROW = "duplicate_row"
OVERLAPPING_PAIR = "overlapping_pair"


@dataclass(frozen=True)
class LabelledSegment:
    """One line of the label file: an action between two images, or without bounds where the file says NaN."""

    label: str
    bounds: tuple[int, int] | None


def recording_files(path: Path) -> list[Path]:
    """List the recording files of the set's folder.

    Raises:
        DatasetError: there is none.
    """
    return files_of(path, PATTERN)


def read_recording(path: Path, sensor: str, segments: list[LabelledSegment] | None = None) -> Take:
    """Read one recording and mark its segments. Of rows with the same image number the first is kept.

    Raises:
        DatasetError: the name or the content is not of the set's form.
    """
    match = NAME.fullmatch(path.name)
    if match is None:
        raise DatasetError(f"{path} is not named like joints_s01_e01.txt: keep the data set's own file names")
    name = match[1]
    rows = read_rows(path, columns=1 + 3 * SOURCE_JOINTS)
    if rows[0, 0] < 0 or (np.diff(rows[:, 0]) < 0).any():
        raise DatasetError(
            f"{path}: the image numbers in the first column are negative or decrease: download the file again"
        )
    is_first = np.append(True, np.diff(rows[:, 0]) != 0)
    segments = segments or []
    return Take(
        name,
        person=str(int(match["person"])),
        frames=[
            frame_of_person(_stamp_ns(int(row[0])), row[1:].reshape(SOURCE_JOINTS, 3), sensor, name)
            for row in rows[is_first]
        ],
        marks=[mark for segment in segments for mark in _marks(segment, sensor, name)],
        metadata={"execution": str(int(match["execution"]))},
        oddities=+Counter({DUPLICATE_ROW: int((~is_first).sum()), OVERLAPPING_PAIR: overlapping_pairs(segments)}),
        skipped=[f"{name} {segment.label}" for segment in segments if segment.bounds is None],
    )


def read_labelled(path: Path, sensor: str, labels: dict[str, list[LabelledSegment]]) -> Take:
    """Read one recording with the segments that the label file gives it.

    Raises:
        DatasetError: as `read_recording`, or the label file does not name the recording.
    """
    name = path.stem.removeprefix("joints_")
    if name not in labels:
        raise DatasetError(f"{LABELS} has no entry {name} for {path}: use the label file that belongs to the data set")
    return read_recording(path, sensor, labels[name])


def read_labels(folder: Path) -> dict[str, list[LabelledSegment]]:
    """Read the corrected label file: the segments of each recording, by name (`s01_e01`).

    Raises:
        DatasetError: the corrected file is missing, or a line is not of its form.
    """
    path = folder / LABELS
    if not path.is_file():
        is_original = (folder / ORIGINAL_LABELS).is_file()
        hint = f" (some starts and ends in {ORIGINAL_LABELS} are wrong)" if is_original else ""
        raise DatasetError(f"{path} is missing{hint}: put the corrected label file {LABELS} next to the recordings")
    recordings: dict[str, list[LabelledSegment]] = {}
    segments: list[LabelledSegment] | None = None
    for number, line in enumerate(path.read_text().splitlines(), start=1):
        text = line.strip()
        if HEADING.fullmatch(text):
            segments = recordings.setdefault(text, [])
        elif text:
            segment = _labelled_segment(text)
            if segment is None or segments is None:
                raise DatasetError(
                    f"{path}, line {number}: {text!r} does not have the form `action: start end`: correct this line"
                )
            segments.append(segment)
    return recordings


def overlapping_pairs(segments: list[LabelledSegment]) -> int:
    """Count the pairs of segments that have an image in common."""
    bounds = [segment.bounds for segment in segments if segment.bounds is not None]
    return sum(max(a[0], b[0]) <= min(a[1], b[1]) for a, b in combinations(bounds, 2))


def _labelled_segment(text: str) -> LabelledSegment | None:
    match = LABEL.fullmatch(text)
    if match is None:
        return None
    if "NaN" in (match["start"], match["end"]):
        return LabelledSegment(match["label"], None)
    start, end = int(match["start"]), int(match["end"])
    return LabelledSegment(match["label"], (start, end)) if start <= end else None


def _marks(segment: LabelledSegment, sensor: str, name: str) -> list[Segment]:
    if segment.bounds is None:
        return []
    start_ns, end_ns = map(_stamp_ns, segment.bounds)
    return segment_marks(start_ns, end_ns, sensor, f"{name}-{segment.label}", segment.label)


def _stamp_ns(image: int) -> int:
    return stamp_of(image, IMAGES_PER_SECOND)
