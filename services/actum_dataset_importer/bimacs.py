"""OptiTrack takes of bimanual actions: two hands and some objects at 60 Hz, actions labelled for each hand.

`subject0_take0.csv` holds poses in metres in a world frame with z up; `labels_subject_0/<task>/take_0.json` holds, for
each hand, frame numbers and between them `[action, object class, instance]` in the ids of the KIT Bimanual Actions
Dataset (Dreher, Wächter, Asfour 2020).

A take has no camera and no body. The world frame stands in for the camera's, its axes turned: x right is the world's x,
y down the world's -z, z forward the world's y. Postures hold the hands alone and say `frame = "world"`.
"""

import csv
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from itertools import pairwise
from pathlib import Path
from typing import Any

from actum.messages import Hand, Joint, Message, Objects, Posture, Segment, TrackedObject, Truth, segment_marks
from actum.skeletons import INDEX, JOINTS
from actum_dataset_importer.takes import DatasetError

PATTERN = "subject*_take*.csv"
NAME = re.compile(r"subject(?P<person>\d+)_take(?P<take>\d+)")
AGENT = 1
"""The one person of a take."""
WORLD = "world"

ACTIONS = (
    "idle", "approach", "retreat", "lift", "place", "hold", "pour", "cut", "hammer", "saw", "stir", "screw", "drink",
    "wipe",
)  # fmt: skip
"""The names of the actions, by their id in the labels, 0 to 13."""

OBJECTS = (
    "bowl", "knife", "screwdriver", "cutting board", "whisk", "hammer", "bottle", "cup", "banana", "cereals", "sponge",
    "wood", "saw", "hard drive",
)  # fmt: skip
"""The names of the object classes, by their number in the labels, 0 to 13. A class's number serves as the object's id,
so that two instances of a class count as one object."""

VALID = "_valid"
HANDS: Mapping[Hand, str] = {"right": "HandRight", "left": "HandLeft"}

EGO_FROM_CAMERA = [-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
"""Keeps the origin, and turns the axes to left, up, forward, as in the egocentric frame: 4x4, row-major."""

Row = Mapping[str, str]
Point = list[float]


@dataclass(frozen=True)
class HandsTake:
    """One take: postures and objects frame by frame, and the labelled segments of each hand.

    Attributes:
        marks: start and end of each segment; they do not name the object.
        truths: the object that the label of each segment names; a label without an object has none.
        skipped: names of the segments that do not end after they start.
    """

    name: str
    person: str
    postures: list[Posture]
    objects: list[Objects]
    marks: list[Segment] = field(default_factory=list)
    truths: list[Truth] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)

    def messages(self) -> Iterator[Message]:
        """Yield everything, kind by kind."""
        yield from (*self.postures, *self.objects, *self.marks, *self.truths)


@dataclass(frozen=True)
class Label:
    """What one hand does from frame `first` to frame `last`, both included; `target` is an object's id."""

    hand: Hand
    first: int
    last: int
    action: str
    target: int | None


def take_files(folder: Path) -> list[Path]:
    """List the takes of a folder by person and number.

    Raises:
        DatasetError: there is none.
    """
    files = [file for file in folder.glob(PATTERN) if NAME.fullmatch(file.stem)]
    if not files:
        raise DatasetError(
            f"{folder} contains no file named {PATTERN}: give the folder of the data set that contains such files"
        )
    return sorted(files, key=lambda file: tuple(map(int, re.findall(r"\d+", file.stem))))


def read_take(path: Path, sensor: str) -> HandsTake:
    """Read one take with its labels.

    Raises:
        DatasetError: the name, the table or the labels are not of the set's form.
    """
    match = NAME.fullmatch(path.stem)
    if match is None:
        raise DatasetError(f"{path} is not named like subject0_take0.csv: keep the data set's own file names")
    labels = _labels(path.parent, match["person"], match["take"])
    try:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        stamps_ns = [int(Decimal(row["stamp"]) * 10**9) for row in rows]
        postures = [_posture(row, ns, sensor, path.stem) for row, ns in zip(rows, stamps_ns, strict=True)]
        objects = _objects(rows, stamps_ns, sensor, path.stem)
        _check_targets(labels, _bodies(rows))
        kept = [label for label in labels if label.first < label.last]
        named = [(f"{path.stem}_{label.hand}_{number:02d}", label) for number, label in enumerate(kept)]
        marks = [mark for name, label in named for mark in _marks(label, name, stamps_ns, sensor)]
        truths = [_truth(label, name, stamps_ns, sensor) for name, label in named if label.target is not None]
    except (KeyError, TypeError, ValueError, IndexError, InvalidOperation) as error:
        raise DatasetError(
            f"{path} lacks the time stamp or a pose of a labelled frame ({error!r}): download the file again"
        ) from None
    skipped = [f"{path.stem} {label.hand} {label.action}" for label in labels if label.first >= label.last]
    return HandsTake(path.stem, match["person"], postures, objects, marks, truths, skipped)


def camera_from_world(point: Sequence[float]) -> Point:
    """Turn a point (3,) in the world's axes (z up) into the camera's (x right, y down, z forward)."""
    x, y, z = point
    return [x, -z, y]


def _position(row: Row, body: str) -> Point | None:
    """Read a rigid body's position (3,; m, camera frame), None where the cameras lost it."""
    if row[f"{body}{VALID}"] != "1":
        return None
    x, y, z = (float(row[f"{body}_{axis}"]) for axis in "xyz")
    return camera_from_world((x, y, z)) if math.isfinite(x + y + z) else None


def _posture(row: Row, stamp_ns: int, sensor: str, session_id: str) -> Posture:
    joints: list[Joint] = [None] * len(JOINTS)
    for hand, body in HANDS.items():
        position = _position(row, body)
        joints[INDEX[f"{hand}_hand"]] = None if position is None else [-position[0], -position[1], position[2]]
    return Posture(
        stamp_ns=stamp_ns,
        sensor=sensor,
        agent=AGENT,
        joints_m=joints,
        joints=None,
        ego_from_camera=EGO_FROM_CAMERA,
        motion=None,
        frame=WORLD,
        agents=[AGENT],
        session_id=session_id,
    )


def _bodies(rows: Sequence[Row]) -> dict[int, str]:
    """Return, for each object class of the table by its number, the prefix of its columns' names."""
    known = {name.replace(" ", ""): number for number, name in enumerate(OBJECTS)}
    bodies = [column.removesuffix(VALID) for column in rows[0] if column.endswith(VALID)] if rows else []
    return {known[name]: body for body in bodies if (name := body.lower().replace("_", "")) in known}


def _check_targets(labels: Sequence[Label], bodies: Mapping[int, str]) -> None:
    for label in labels:
        if label.target is not None and label.target not in bodies:
            raise ValueError(
                f"the labels name the object {OBJECTS[label.target]}, but the file of positions has no columns for "
                "this object; download both files again"
            )


def _objects(rows: Sequence[Row], stamps_ns: Sequence[int], sensor: str, session_id: str) -> list[Objects]:
    """Read the objects of each frame; one that the cameras lost keeps its last position, unseen."""
    last: dict[int, TrackedObject] = {}
    bodies = _bodies(rows)
    frames = []
    for row, stamp_ns in zip(rows, stamps_ns, strict=True):
        for number, body in bodies.items():
            position = _position(row, body)
            if position is not None:
                x, y, z, w = (float(row[f"{body}_q{axis}"]) for axis in "xyzw")
                last[number] = TrackedObject(
                    id=number,
                    name=OBJECTS[number],
                    position_m=position,
                    quaternion_xyzw=[*camera_from_world((x, y, z)), w],
                    confidence=1.0,
                    seen=True,
                )
            elif number in last:
                last[number] = last[number].model_copy(update={"seen": False, "confidence": 0.0})
        listed = list(last.values())
        frames.append(Objects(stamp_ns=stamp_ns, sensor=sensor, objects=listed, session_id=session_id))
    return frames


def _labels(folder: Path, person: str, take: str) -> list[Label]:
    files = sorted(folder.glob(f"labels_subject_{person}/*/take_{take}.json"))
    if not files:
        raise DatasetError(
            f"{folder} contains no labels_subject_{person}/*/take_{take}.json: put the folder labels_subject_{person} "
            f"next to subject{person}_take{take}.csv"
        )
    file = files[0]
    try:
        content = json.loads(file.read_text())
        return [label for hand in HANDS for label in _hand_labels(hand, content[f"{hand}_hand"])]
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise DatasetError(f"{file} is damaged ({error!r}): download the file again") from None


def _hand_labels(hand: Hand, content: list[Any]) -> list[Label]:
    """Read one hand's labels from `[frame, label, frame, label, …, frame]`."""
    frames, labels = content[0::2], content[1::2]
    return [
        Label(hand, first, last, ACTIONS[action], target)
        for (first, last), (action, target, _) in zip(pairwise(frames), labels, strict=True)
    ]


def _marks(label: Label, segment_id: str, stamps_ns: Sequence[int], sensor: str) -> list[Segment]:
    start_ns, end_ns = stamps_ns[label.first], stamps_ns[label.last]
    return segment_marks(start_ns, end_ns, sensor, segment_id, label.action, AGENT, label.hand)


def _truth(label: Label, segment_id: str, stamps_ns: Sequence[int], sensor: str) -> Truth:
    assert label.target is not None
    return Truth(
        stamp_ns=stamps_ns[label.last],
        sensor=sensor,
        kind="end",
        segment_id=segment_id,
        agent=AGENT,
        hand=label.hand,
        action=label.action,
        object_id=label.target,
        object_name=OBJECTS[label.target],
        displacement_m=None,
    )
