"""Recordings as OpenNI's own recorder writes them from a camera: records of properties and uncompressed frames."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

DEPTH, IMAGE = 2, 3
NODE_ADDED, INT_PROPERTY, GENERAL_PROPERTY, DATA_BEGIN, STATE_READY, NEW_DATA, END = 0x0D, 3, 6, 8, 9, 0x0A, 0x0B
FORMATS = {DEPTH: (4, 100), IMAGE: (1, 200)}
"""Pixel formats of each kind of node, in OpenNI 1's and OpenNI 2's numbers: depth in mm, red-green-blue."""

FOREVER = 2**64 - 1


@dataclass(frozen=True)
class Track:
    """One stream: frames (height, width[, 3]), their times, and what the file tells of the sensor."""

    kind: int
    frames: Sequence[NDArray[Any]]
    stamps_us: Sequence[int]
    field_of_view_rad: tuple[float, float] | None = None
    mirrored: bool = False


def write_oni(path: Path, *tracks: Track) -> Path:
    """Write a recording of streams, in order of time."""
    with path.open("wb") as file:
        file.write(struct.pack("<4sBBHIQI", b"NI10", 1, 0, 1, 0, FOREVER, len(tracks)))
        for node, track in enumerate(tracks, start=1):
            file.write(_described(node, track))
        for node, track in enumerate(tracks, start=1):
            file.write(_record(DATA_BEGIN, node, struct.pack("<IQ", len(track.frames), max(track.stamps_us))))
        for stamp_us, number, node, frame in _in_order(tracks):
            fields = struct.pack("<QI", stamp_us, number)
            file.write(_record(NEW_DATA, node, fields, np.ascontiguousarray(frame).tobytes()))
        file.write(_record(END, 0, b""))
    return path


def _in_order(tracks: Sequence[Track]) -> list[tuple[int, int, int, NDArray[Any]]]:
    frames = [
        (stamp_us, number, node, frame)
        for node, track in enumerate(tracks, start=1)
        for number, (stamp_us, frame) in enumerate(zip(track.stamps_us, track.frames, strict=True), start=1)
    ]
    return sorted(frames, key=lambda frame: frame[:3])


def _described(node: int, track: Track) -> bytes:
    height, width = track.frames[0].shape[:2]
    old_format, new_format = FORMATS[track.kind]
    name = b"Depth\0" if track.kind == DEPTH else b"Image\0"
    added = struct.pack("<I", len(name)) + name
    added += struct.pack("<I4sIQQQ", track.kind, b"NONE", len(track.frames), 0, FOREVER, 0)
    records = [
        _record(NODE_ADDED, node, added),
        _number(node, "oniRequiredFrameSize", track.frames[0].nbytes),
        _number(node, "xnIsGenerating", 1),
        _general(node, "xnMapOutputMode", struct.pack("<III", width, height, 30)),
        _number(node, "xnPixelFormat", old_format),
        _number(node, "oniPixelFormat", new_format),
        _general(node, "xnCropping", struct.pack("<I4H", 0, 0, 0, 0, 0)),
        _number(node, "xnMirror", int(track.mirrored)),
    ]
    if track.kind == DEPTH:
        records.append(_number(node, "xnDeviceMaxDepth", 10_000))
    if track.field_of_view_rad is not None:
        records.append(_general(node, "xnFOV", struct.pack("<dd", *track.field_of_view_rad)))
    return b"".join(records) + _record(STATE_READY, node, b"")


def _number(node: int, name: str, value: int) -> bytes:
    return _record(INT_PROPERTY, node, _property(name, struct.pack("<Q", value)))


def _general(node: int, name: str, value: bytes) -> bytes:
    return _record(GENERAL_PROPERTY, node, _property(name, value))


def _property(name: str, value: bytes) -> bytes:
    text = name.encode() + b"\0"
    return struct.pack("<I", len(text)) + text + struct.pack("<I", len(value)) + value


def _record(kind: int, node: int, fields: bytes, payload: bytes = b"") -> bytes:
    header = struct.pack("<4sIIIIQ", b"NIR\0", kind, node, 28 + len(fields), len(payload), 0)
    return header + fields + payload
