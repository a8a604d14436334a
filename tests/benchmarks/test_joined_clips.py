from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.camera.joined_clips import FRAMES_PER_SECOND, SIZE, STILL_FRAMES, joined, stamp_ns

from sensor_gateway.devices.video import pictures_of

pytestmark = pytest.mark.thorough

LENGTHS = {"category1": 9, "category2": 14, "category5": 11}
"""Frames of a clip in which somebody waves, one in which they drink, and one of what nobody labels."""


def write_clips(folder: Path) -> None:
    for category, frames in LENGTHS.items():
        path = folder / f"GestureRecording_Id1actor1idAction1{category}.mp4"
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), FRAMES_PER_SECOND, SIZE)
        for _ in range(frames):
            writer.write(np.full((SIZE[1], SIZE[0], 3), 10 * frames, dtype=np.uint8))
        writer.release()


def test_clips_follow_each_other_with_stills_between(tmp_path: Path) -> None:
    write_clips(tmp_path)
    video = joined(tmp_path, "1", tmp_path / "joined.avi")
    shown = [round(float(picture.image_bgr.mean()) / 10) for picture in pictures_of(video.path)]
    assert len(shown) == sum(LENGTHS.values()) + len(LENGTHS) * 2 * STILL_FRAMES
    for part in video.parts:
        frames = part.last - part.first + 1
        around = shown[part.first - STILL_FRAMES : part.last + STILL_FRAMES + 1]
        assert around == [frames] * (frames + 2 * STILL_FRAMES)


def test_what_nobody_labels_is_background(tmp_path: Path) -> None:
    write_clips(tmp_path)
    video = joined(tmp_path, "1", tmp_path / "joined.avi")
    assert {part.label for part in video.parts} == {"wave", "drink", "tight lace"}
    marked = {(mark.stamp_ns, mark.label) for mark in video.marks("kinect0") if mark.kind == "start"}
    assert marked == {(stamp_ns(p.first), p.label) for p in video.parts if p.label != "tight lace"}


def test_other_people_are_left_out(tmp_path: Path) -> None:
    write_clips(tmp_path)
    assert joined(tmp_path, "2", tmp_path / "joined.avi").parts == ()
