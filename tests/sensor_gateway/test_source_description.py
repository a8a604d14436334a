"""What a gateway says that it reads."""

from pathlib import Path
from typing import Any, get_args

import pytest

from camera_videos import write_video
from sensor_gateway.settings import Settings, SourceName
from sensor_gateway.sources import CAMERAS, description


def test_every_source_that_can_be_named_is_a_camera_or_recordings() -> None:
    assert {*get_args(SourceName)} == {*CAMERAS, "recording"}


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"source": "camera"}, "camera 0"),
        ({"source": "camera", "camera": "/dev/video2"}, "camera /dev/video2"),
        ({"source": "camera", "camera": "nowhere/wave.MP4"}, "file nowhere/wave.MP4 (camera)"),
        ({"source": "camera", "camera": "http://lab:8080/v.mp4"}, "camera http://lab:8080/v.mp4"),
        ({"source": "camera", "camera": "rtsp://me:secret@lab/a?token=secret"}, "camera rtsp://lab/a"),
        ({"source": "marker-camera", "camera": 1}, "marker camera 1"),
        ({"source": "realsense"}, "camera (realsense)"),
        ({"source": "openni2", "path": "walk.oni"}, "file walk.oni (openni2)"),
        ({"source": "recording", "path": "a.mcap"}, "file a.mcap (recording)"),
        ({"source": "recording", "path": "."}, "folder . (recording)"),
    ],
)
def test_a_sensor_is_told_by_what_it_is(settings: dict[str, Any], said: str) -> None:
    assert description(Settings(**settings)) == said


def test_a_file_of_any_name_is_told_to_be_one(tmp_path: Path) -> None:
    video = write_video(tmp_path / "a.avi").rename(tmp_path / "clip")
    assert description(Settings(source="camera", camera=str(video))) == f"file {video} (camera)"
