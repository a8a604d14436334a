"""`actum markers` and `actum calibrate` as a person uses them."""

import json
from pathlib import Path

import cv2
import numpy as np
import pypdfium2
import pytest

from actum.calibration import Calibration
from actum_calibrator.board import Board
from actum_command.commands import calibrate_up_command
from boards import Lens, facing, good_poses, photograph
from command_lines import invoke, written
from people import FRAME_NS, STANDING, lacking, reaches, skeleton

BOARD, LENS = Board(), Lens()
TRUE = np.eye(4)
TRUE[:3, :3] = cv2.Rodrigues(np.radians([0.0, -10.0, 0.0]))[0]
TRUE[:3, 3] = (0.15, 0.01, 0.02)
PLACES = (((-0.05, 0, 0.6), (30, 0, 0)), ((0.05, 0.05, 0.7), (0, 32, 0)), ((0.0, -0.05, 0.65), (20, -26, 15)))


def run(*arguments: str | Path, code: int = 0) -> str:
    done = invoke(*arguments)
    assert done.exit_code == code, done.output
    return " ".join((done.output if code == 0 else done.output + done.stderr).split())


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    made = tmp_path_factory.mktemp("pictures")
    for n, pose in enumerate(good_poses(BOARD, 10)):
        cv2.imwrite(str(made / f"{n}.png"), photograph(LENS, BOARD, pose, seed=n))
    return made


def test_from_pictures_to_a_calibration_of_two_cameras(folder: Path, tmp_path: Path) -> None:
    one, whole = tmp_path / "camera.yaml", tmp_path / "both.yaml"
    said = run("calibrate", "intrinsics", folder, "-o", one)
    found = Calibration.load(one)
    assert found.K[0] == pytest.approx(LENS.intrinsics[0, 0], rel=0.005)
    assert f"focal length {found.K[0]:.1f} ±" in said
    assert "RMS 0." in said
    assert "coverage" in said
    assert found.id in said
    assert (tmp_path / "camera-coverage.png").read_bytes().startswith(b"\x89PNG")
    assert str(tmp_path / "camera-coverage.png") in said

    for n, (place, turn) in enumerate(PLACES):
        pose = facing(BOARD, place, turn)
        for end, camera in (("a", np.eye(4)), ("b", TRUE)):
            cv2.imwrite(str(tmp_path / f"{n}_{end}.png"), photograph(LENS, BOARD, camera @ pose, seed=n))
    pairs = sorted(tmp_path.glob("*_[ab].png"))
    said = run("calibrate", "extrinsics", "--markers-camera", one, "--people-camera", one, *pairs, "-o", whole)
    made = Calibration.load(whole)
    assert made.skeleton_from_image is not None
    assert np.reshape(made.skeleton_from_image, (4, 4))[:3, 3] == pytest.approx(TRUE[:3, 3], abs=0.003)
    assert made.K == found.K
    assert made.id in said


def test_neither_the_calibration_nor_its_picture_overwrites_a_photograph(folder: Path, tmp_path: Path) -> None:
    photographs = {tmp_path / file.name: file.read_bytes() for file in folder.iterdir()}
    photographs[tmp_path / "cam.png"] = photographs.pop(tmp_path / "0.png")
    for file, data in photographs.items():
        file.write_bytes(data)
    run("calibrate", "intrinsics", tmp_path, "-o", tmp_path / "cam.yaml")
    assert all(file.read_bytes() == data for file, data in photographs.items())
    assert set(tmp_path.iterdir()) == {*photographs, tmp_path / "cam.yaml", tmp_path / "cam-coverage.png"}


def test_a_picture_that_would_be_overwritten_is_named_before_anything_is_looked_at(
    folder: Path, tmp_path: Path
) -> None:
    photograph_file = tmp_path / "cam-coverage.png"
    photograph_file.write_bytes(b"a photograph")
    said = run("calibrate", "intrinsics", folder, photograph_file, "-o", tmp_path / "x" / ".." / "cam.yaml", code=1)
    assert "the output would overwrite the input picture" in said
    assert "is not an image" not in said
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [b"a photograph"]


@pytest.mark.parametrize("command", ["intrinsics", "extrinsics"])
@pytest.mark.parametrize("name", ["result.png", "result.JPG", "result.tiff"])
def test_a_calibration_named_as_a_picture_is_refused(folder: Path, tmp_path: Path, command: str, name: str) -> None:
    any_file = tmp_path / "c.yaml"
    any_file.write_text("")
    cameras = ["--markers-camera", any_file, "--people-camera", any_file] if command == "extrinsics" else []
    said = run("calibrate", command, *cameras, folder, "-o", tmp_path / name, code=1)
    assert f"does not end in .yaml or .yml: name the file {tmp_path / 'result.yaml'}" in said
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize("command", ["intrinsics", "markers"])
def test_a_folder_that_is_missing_is_made(command: str, folder: Path, tmp_path: Path) -> None:
    made = tmp_path / "new" / "folder" / ("m.pdf" if command == "markers" else "camera.yaml")
    run(*(["markers"] if command == "markers" else ["calibrate", "intrinsics", folder]), "-o", made)
    assert made.is_file()


@pytest.mark.parametrize("command", ["intrinsics", "extrinsics", "markers"])
def test_a_file_that_cannot_be_written_is_refused_before_any_work(command: str, folder: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    camera = tmp_path / "camera.yaml"
    camera.write_text("no calibration")
    output = tmp_path / "file" / ("m.pdf" if command == "markers" else "c.yaml")
    arguments = {
        "intrinsics": ["calibrate", "intrinsics", tmp_path / "no picture"],
        "extrinsics": ["calibrate", "extrinsics", "--markers-camera", camera, "--people-camera", camera, folder],
        "markers": ["markers"],
    }
    assert f"{output} cannot be written (Not a directory): give another file" in run(
        *arguments[command], "-o", output, code=1
    )


def test_blurred_pictures_are_refused_and_nothing_is_written(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        cv2.imwrite(str(tmp_path / file.name), cv2.GaussianBlur(cv2.imread(str(file)), (0, 0), 5.0))
    said = run("calibrate", "intrinsics", tmp_path, "-o", tmp_path / "c.yaml", code=1)
    assert "too few views: 0 are usable" in said
    assert "10 pictures are blurred: hold the board still" in said
    assert not (tmp_path / "c.yaml").exists()


def test_too_few_pictures_are_refused(folder: Path, tmp_path: Path) -> None:
    files = sorted(folder.iterdir())[:4]
    assert "too few views: 4 are usable" in run("calibrate", "intrinsics", *files, "-o", tmp_path / "c.yaml", code=1)


def test_broken_and_foreign_pictures_are_named(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"no picture")
    said = run("calibrate", "intrinsics", tmp_path / "broken.png", folder, "-o", tmp_path / "c.yaml")
    assert "broken.png: the file is not an image" in said


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--board", "7by5"], "write COLUMNSxROWS, such as 7x5"),
        (["--family", "DICT"], "not a marker family"),
        (["--live"], "give either pictures of the board or --live"),
    ],
)
def test_impossible_options_are_refused(folder: Path, tmp_path: Path, options: list[str], reason: str) -> None:
    assert reason in run("calibrate", "intrinsics", folder, "-o", tmp_path / "c.yaml", *options, code=1)


def test_a_foreign_calibration_is_refused(folder: Path, tmp_path: Path) -> None:
    bad = tmp_path / "c.yaml"
    bad.write_text("focal: 500")
    command = ["--markers-camera", bad, "--people-camera", bad, folder, "-o", tmp_path / "d.yaml"]
    assert "c.yaml is not a calibration" in run("calibrate", "extrinsics", *command, code=1)


def test_markers_are_printed_to_a_file(tmp_path: Path) -> None:
    said = run("markers", "-o", tmp_path / "m.pdf", "--ids", "1,4-6", "--size-mm", "60", "--paper", "letter")
    assert "100 %" in said
    with pypdfium2.PdfDocument(tmp_path / "m.pdf") as document:
        text = document[0].get_textpage().get_text_range()
    assert all(f"id {number}" in text.splitlines() for number in (1, 4, 5, 6))


def test_the_board_is_printed_to_a_file(tmp_path: Path) -> None:
    assert "7x5 squares of 35 mm" in run("markers", "-o", tmp_path / "b.pdf", "--board")
    assert (tmp_path / "b.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("ids", ["", "a", "5-1", "1,,2", "0-99999999999"])
def test_ids_that_are_none_are_refused(tmp_path: Path, ids: str) -> None:
    assert "--ids" in run("markers", "-o", tmp_path / "m.pdf", "--ids", ids, code=1)


def test_how_a_camera_is_tilted_is_found_in_a_recording(tmp_path: Path) -> None:
    standing, acting = tmp_path / "standing.mcap", tmp_path / "acting.mcap"
    looking_up = cv2.Rodrigues(np.radians([-12.0, 0.0, 0.0]))[0]
    written(standing, *(skeleton(k * FRAME_NS, STANDING @ looking_up.T) for k in range(70)))
    written(acting, *reaches(30), person="1")

    said = run("calibrate", "up", standing)
    pitch_deg = float(said.split("looks up by ")[1].split()[0])
    up = json.loads(said.split("ACTUM_UP_IN_CAMERA='")[1].rstrip("'"))
    assert pitch_deg == pytest.approx(12.0, abs=3.0)
    assert up == pytest.approx([0.0, -np.cos(np.radians(pitch_deg)), np.sin(np.radians(pitch_deg))], abs=0.01)
    assert "nobody stood upright and still for two seconds" in run("calibrate", "up", acting, code=1)
    assert "the file is not an MCAP file" in run("calibrate", "up", Path(__file__), code=1)


def test_who_flickers_in_and_out_of_view_is_told_what_to_do_no_more_than_twice_a_second(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    footless = lacking(STANDING, "left_foot", "right_foot")
    frames = [skeleton(k * FRAME_NS, STANDING if k % 2 else footless) for k in range(150)]
    monkeypatch.setattr(calibrate_up_command, "_live", lambda: iter(frames))
    done = invoke("calibrate", "up")
    told = [line for line in done.stdout.splitlines() if line.strip()]
    assert "not visible: left_foot" in told[0]
    assert "stay like that" in told[1]
    assert 5 < len(told) <= 10
