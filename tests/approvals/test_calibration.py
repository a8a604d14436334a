"""What the calibrator finds for boards seen by known cameras, and what it draws and prints."""

import datetime
from collections.abc import Iterator

import cv2
import numpy as np
import pypdfium2
import pytest
from PIL import ImageDraw

from actum.calibration import Calibration
from actum_calibrator.board import Board
from actum_calibrator.board_sheet import board_sheet
from actum_calibrator.board_views import View
from actum_calibrator.coverage_picture import coverage_picture
from actum_calibrator.extrinsics import estimate_extrinsics, with_extrinsics
from actum_calibrator.intrinsics import calibration_of, estimate_intrinsics
from actum_calibrator.marker_sheet import marker_sheet
from actum_calibrator.pairs import Pair
from actum_calibrator.sheet_sizes import SheetSize
from actum_calibrator.view_collector import PairCollector, ViewCollector
from actum_calibrator.view_set import nominal_tilts_deg, shortcomings
from approving import Approve
from boards import Lens, facing, good_poses
from calls import calls_of

BOARD = Board()
MARKERS_LENS = Lens()
PEOPLE_LENS = Lens(matrix=(530.0, 532.0, 314.0, 245.0), distortion=(0.06, -0.1, 0.0, 0.0, 0.0))
DAY = datetime.date(2026, 1, 2)


def view(lens: Lens, pose: np.ndarray, name: str, seed: int, bend_m: float = 0.0) -> View:
    """Project the corners of a board that is bent a little; a quarter of them is covered."""
    rng = np.random.default_rng(seed)
    corners_m = BOARD.corners_m.copy()
    corners_m[:, 2] += bend_m * ((corners_m[:, 0] - corners_m[:, 0].mean()) / BOARD.width_m) ** 2
    rotation, _ = cv2.Rodrigues(pose[:3, :3])
    projected, _ = cv2.projectPoints(corners_m, rotation, pose[:3, 3], lens.intrinsics, np.array(lens.distortion))
    ids = sorted(rng.choice(len(corners_m), 3 * len(corners_m) // 4, replace=False).tolist())
    corners_px = projected.reshape(-1, 2)[ids] + rng.normal(0, 0.08, (len(ids), 2))
    return View(name, lens.size, BOARD, ids, corners_px, 0.7)


POSES = good_poses(BOARD)
VIEWS = [view(MARKERS_LENS, pose, f"view {n}", n, 0.002) for n, pose in enumerate(POSES)]


def test_intrinsics_are_found_and_drawn_as_approved(approve: Approve, monkeypatch: pytest.MonkeyPatch) -> None:
    found = estimate_intrinsics(VIEWS)
    calls = calls_of(monkeypatch, ImageDraw.ImageDraw, "line", "rectangle", "ellipse", "text")
    png = coverage_picture(found, VIEWS)
    shape = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR).shape
    about = [calibration_of(found, DAY), found.coverage, found.rms_of_views_px, shortcomings(VIEWS[:4])]
    approve("intrinsics", {"found": found, "about": about, "tilts": nominal_tilts_deg(VIEWS)}, 1e-5)
    approve("coverage-picture", {"calls": calls, "shape": shape}, 1e-5)


def test_extrinsics_are_found_as_approved(approve: Approve) -> None:
    people_from_markers = facing(BOARD, (0.25, 0.02, 0.05), (3, -18, 4))
    seen = [view(PEOPLE_LENS, people_from_markers @ pose, "people", n) for n, pose in enumerate(POSES[1:6])]
    pairs = [Pair(own.name, own, other) for own, other in zip(VIEWS[1:6], seen, strict=True)]
    markers, people = calibration(MARKERS_LENS), calibration(PEOPLE_LENS)
    found = estimate_extrinsics(pairs, markers, people)
    approve("extrinsics", [found, with_extrinsics(markers, found, DAY)], 1e-5)


def calibration(lens: Lens) -> Calibration:
    return Calibration(image_size=lens.size, K=lens.intrinsics.ravel().tolist(), distortion=list(lens.distortion))


def test_sheets_are_printed_as_approved(approve: Approve) -> None:
    sheets = {
        "board": board_sheet(BOARD, SheetSize.A4),
        "markers": marker_sheet("DICT_4X4_50", range(9), 60.0, SheetSize.LETTER),
        "small": marker_sheet("DICT_APRILTAG_36h11", [0, 17], 22.0, SheetSize.A4),
    }
    approve("sheets", {name: objects(pdf) for name, pdf in sheets.items()}, 1e-5)


def objects(pdf: bytes) -> list[object]:
    """Return the bounds of all that stands on each page (points), by type, and its text."""
    with pypdfium2.PdfDocument(pdf) as document:
        return [
            {
                "text": page.get_textpage().get_text_range(),
                "bounds": [{f"type {each.type}": np.array(each.get_bounds())} for each in page.get_objects()],
            }
            for page in document
        ]


def shown(seed: int) -> Iterator[View]:
    """Yield views of a board that is moved to a place and held there, more or less still, sixty times."""
    rng = np.random.default_rng(seed)
    place_m, turn_deg = np.array([0, 0, 0.7]), np.zeros(3)
    for number in range(60):
        for step in 10 ** rng.uniform([-2, -4], [-0.6, -2.3]):
            place_m = np.clip(place_m + rng.normal(0, step, 3), (-0.25, -0.2, 0.4), (0.25, 0.2, 1.0))
            turn_deg = np.clip(turn_deg + rng.normal(0, 150 * step, 3), -35, 35)
            yield view(MARKERS_LENS, facing(BOARD, place_m, turn_deg), f"view {number}", number)


def taken_of(seed: int) -> dict[str, object]:
    """Return what is asked for after each view that is taken, and which pairs two cameras take."""
    one, two, views = ViewCollector(), PairCollector(), list(shown(seed))
    asked = [one.instruction for each in views if one.offer(each)]
    seen = zip(views, shown(seed + 100), strict=True)
    pairs = [f"{two.offer(camera, each)} {two.complete}" for both in seen for camera, each in enumerate(both)]
    numbered = {f"{number:02}": text for number, text in enumerate(asked)}
    taken = [each.corners_px for each in one.views]
    return {"asked": numbered, "taken": taken, "complete": one.complete, "pairs": pairs}


def test_views_are_taken_and_asked_for_as_approved(approve: Approve) -> None:
    growing, asked = ViewCollector(), {}
    for each in VIEWS:
        growing.views.append(each)
        asked[each.name] = growing.instruction
    approve("views", {"good": asked, **{f"shown {seed}": taken_of(seed) for seed in (0, 5)}}, 1e-5)
