"""Joints are drawn where they are, the actor's left in one colour and their right in another."""

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import NoReturn

import cv2
import numpy as np
import pytest

from actum.messages import Agent
from actum.skeletons import INDEX
from actum_command.commands import draw_command, import_commands
from actum_command.skeleton_overlay import LEFT, MIDDLE, RIGHT, drawn, sheet
from camera_bodies import K, as_seen, projected, standing_at
from camera_videos import write_video
from command_lines import invoke
from people import STANDING, lacking, listed
from sensor_gateway.lens import Lens
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.settings import Settings

LENS = Lens(K, np.zeros(5), assumed=False)
GREY = np.full((480, 640, 3), 90, np.uint8)


def picture(joints: np.ndarray) -> np.ndarray:
    agent = Agent(agent=1, joints=listed(joints), confidence=[1.0] * 15)
    return drawn(GREY, [agent], LENS, "")


@pytest.mark.parametrize(
    ("name", "colour"), [("left_elbow", LEFT), ("left_knee", LEFT), ("right_elbow", RIGHT), ("torso", MIDDLE)]
)
def test_each_joint_is_where_it_projects_to_in_the_colour_of_its_side(name: str, colour: tuple[int, int, int]) -> None:
    x, y = projected(STANDING[[INDEX[name]]])[0].round().astype(int)
    assert tuple(picture(STANDING)[y, x]) == colour


def test_a_missing_joint_is_not_drawn_and_the_picture_given_stays_as_it_was() -> None:
    x, y = projected(STANDING[[INDEX["left_elbow"]]])[0].round().astype(int)
    assert tuple(picture(lacking(STANDING, "left_elbow"))[y, x]) == (90, 90, 90)
    assert (GREY == 90).all()


def test_pictures_are_put_side_by_side_row_by_row() -> None:
    levels = [np.full((2, 3, 3), level, np.uint8) for level in (1, 2, 3, 4)]
    assert sheet(levels, columns=3)[::2, ::3, 0].tolist() == [[1, 2, 3], [4, 0, 0]]
    assert sheet(levels[:2], columns=3).shape == (2, 6, 3)


def test_without_a_model_the_command_says_how_to_get_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_POSE_MODEL", str(tmp_path / "pose.task"))
    video = write_video(tmp_path / "a.avi")
    refused = invoke("draw", video, "-o", tmp_path / "a.png")
    assert refused.exit_code == 1
    assert "actum models fetch" in " ".join(refused.stderr.split())
    imported = invoke("import", "video", tmp_path, tmp_path / "out")
    assert imported.exit_code == 1
    assert "actum models fetch" in " ".join(imported.stderr.split())


def test_of_each_imported_clip_one_person_is_found_unless_more_are_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def estimator(settings: Settings) -> NoReturn:
        asked.append(settings.people)
        raise ValueError("no model is needed here")

    monkeypatch.setattr(import_commands, "estimator_of", estimator)
    for more in ([], ["--people", "3"]):
        assert "no model is needed" in invoke("import", "video", tmp_path, tmp_path / "out", *more).stderr
    assert asked == [1, 3]


class Counting:
    """A model that sees one person, always at the same place, and counts the pictures it is shown."""

    def __init__(self) -> None:
        self.asked = 0

    def people(self, image_bgr: np.ndarray, stamp_ns: int) -> list[Landmarks]:
        self.asked += 1
        return [as_seen(standing_at(0.0, 2.5))]


def brightening(path: Path, frames: int) -> Path:
    """Write a video whose picture n has level n."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30, (64, 48))
    for level in range(frames):
        writer.write(np.full((48, 64, 3), level, np.uint8))
    writer.release()
    return path


@pytest.mark.parametrize(("count", "levels"), [(6, [0, 40, 80, 119, 159, 199]), (1, [0]), (2, [0, 199])])
def test_every_frame_is_seen_but_only_those_asked_for_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int, levels: list[int]
) -> None:
    model, captions, backgrounds = Counting(), [], []

    def counted(image_bgr: np.ndarray, agents: Sequence[Agent], lens: Lens, caption: str) -> np.ndarray:
        captions.append(caption)
        backgrounds.append(image_bgr.mean())
        return drawn(image_bgr, agents, lens, caption)

    monkeypatch.setattr(draw_command, "estimator_of", lambda _: nullcontext(model))
    monkeypatch.setattr(draw_command, "drawn", counted)
    video, output = brightening(tmp_path / "a.avi", 200), tmp_path / "a.png"

    done = invoke("draw", video, "-o", output, "--pictures", count)

    assert done.exit_code == 0, done.output
    assert f"{count} of 200 pictures" in done.output
    assert model.asked == 200
    assert len(captions) == count
    assert backgrounds == pytest.approx(levels, abs=3)
    assert [caption.partition(":")[0] for caption in captions] == [f"{level / 30:.2f} s" for level in levels]
    assert not any("nobody" in caption for caption in captions)
    assert cv2.imread(output).shape == (-(-count // 3) * 48, min(count, 3) * 64, 3)


@pytest.mark.parametrize("name", ["a.xyz", "a", "file/a.png", ""])
def test_a_picture_that_cannot_be_written_is_refused_before_the_video_is_seen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    model = Counting()
    monkeypatch.setattr(draw_command, "estimator_of", lambda _: nullcontext(model))
    (tmp_path / "file").touch()
    refused = invoke("draw", str(brightening(tmp_path / "a.avi", 3)), "-o", tmp_path / name)
    assert refused.exit_code == 1
    assert str(tmp_path) in refused.stderr.replace("\n", "")
    assert model.asked == 0


def test_a_folder_that_is_missing_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(draw_command, "estimator_of", lambda _: nullcontext(Counting()))
    output = tmp_path / "new" / "pictures" / "a.png"
    done = invoke("draw", str(brightening(tmp_path / "a.avi", 3)), "-o", output)
    assert done.exit_code == 0, done.output
    assert output.is_file()


@pytest.mark.data
@pytest.mark.pose_model
def test_a_real_clip_becomes_a_sheet(data: Path, tmp_path: Path) -> None:
    clip = data / "florence3d_rgb" / "GestureRecording_Id1actor1idAction1category1.mp4"
    done = invoke("draw", clip, "-o", tmp_path / "a.png", "--pictures", "4")
    assert done.exit_code == 0, done.output
    drawing = cv2.imread(tmp_path / "a.png")
    assert drawing.shape == (2 * 480, 3 * 640, 3)
    first = drawing[:480, :640]
    assert (first == LEFT).all(axis=2).sum() > 300
    left_x, right_x = ((first == colour).all(axis=2).nonzero()[1].mean() for colour in (LEFT, RIGHT))
    assert left_x > right_x, "they face the camera"
