"""What is detected of markers that are small, steep, blurred, in shadow or covered in part."""

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from approving import Approve
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.families import family
from marker_tracker.pose.pose_tracks import Tracks
from marker_tracker.pose.poses import Measurement, Pose

COLUMNS, ROWS, PLACE_PX = 4, 3, 160
TEXELS, QUIET, PAPER, INK = 16, 2, 220, 40
FAMILIES = ("DICT_4X4_50", "DICT_6X6_250", "DICT_APRILTAG_36H11")
Pixels = NDArray[np.uint8]


def picture(name: str, seed: int, blur_px: float, shrunk: float) -> Pixels:
    """Draw twelve markers, each in a place of its own; shadows fall over some, others are covered in part."""
    rng = np.random.default_rng(seed)
    fine = np.full((2 * ROWS * PLACE_PX, 2 * COLUMNS * PLACE_PX), 90.0, np.float32)
    for number, (row, column) in enumerate(np.ndindex(ROWS, COLUMNS)):
        pattern = np.pad(family(name).patterns[number], QUIET, constant_values=True)
        sheet = np.kron(np.where(pattern, PAPER, INK), np.ones((TEXELS, TEXELS))).astype(np.float32)
        edge, middle = len(sheet), 2 * PLACE_PX * (np.array([column, row]) + 0.5)
        corners = square(rng, shrunk * rng.uniform(30, 62)) * [1, rng.uniform(0.35, 1)] * 2 + middle
        flat = np.array([[0, 0], [edge, 0], [edge, edge], [0, edge]], np.float32)
        mapping = cv2.getPerspectiveTransform(flat, corners.astype(np.float32))
        cv2.warpPerspective(sheet, mapping, fine.shape[::-1], fine, borderMode=cv2.BORDER_TRANSPARENT)
        if number % 4 == 3:
            cv2.circle(fine, [round(each) for each in corners[number % 3].tolist()], round(10 * shrunk), 120, -1)
    fine[:, 2 * PLACE_PX : 3 * PLACE_PX] *= 0.5
    image = cv2.GaussianBlur(cv2.resize(fine, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), (0, 0), blur_px)
    return np.clip(image + rng.normal(0, 2, image.shape), 0, 255).astype(np.uint8)


def square(rng: np.random.Generator, half_px: float) -> NDArray[np.float64]:
    angle = rng.uniform(0, 2 * np.pi) + np.pi / 4 + np.pi / 2 * np.arange(4)
    return half_px * np.stack([np.cos(angle), np.sin(angle)], axis=1) * rng.uniform(0.9, 1.1, (4, 1)) * 1.2


def test_markers_that_are_hard_to_see_are_found_as_approved(approve: Approve) -> None:
    found = {}
    for seed, (name, (blur_px, shrunk)) in enumerate(
        (name, way) for name in FAMILIES for way in ((0.6, 1.0), (0.8, 0.5), (1.3, 0.7))
    ):
        detector = MarkerDetector({name: ()} if seed % 2 else {name: range(12)})
        found[f"{name} {shrunk}"] = detector.search(picture(name, seed, blur_px, shrunk))
    approve("markers", found, 1e-5, besides={"covered": 3e-2, "photometric": 2e-4})


def measurements(seed: int) -> Iterator[tuple[int, list[Measurement]]]:
    """Yield what is measured of six objects: each is moved now and then, measured wrongly, covered and lost."""
    rng, noise_m, objects = np.random.default_rng(seed), np.array([0.001, 0.001, 0.006]), range(6)
    places_m, speeds_mps = rng.uniform((-0.3, -0.3, 1.2), (0.3, 0.3, 1.8), (6, 3)), np.zeros((6, 3))
    moves, lost, covered, wrong = (rng.random((150, 6)) < share for share in (0.06, 0.35, 0.15, 0.05))
    for i in range(150):
        speeds_mps = np.where(moves[i][:, None], rng.normal(0, 0.4, (6, 3)), 0.9 * speeds_mps)
        places_m = places_m + speeds_mps / 30
        seen = places_m + rng.normal(0, 1, (6, 3)) * noise_m + wrong[i][:, None] * rng.normal(0, 0.07, (6, 3))
        yield (
            SECOND_NS + i * SECOND_NS // 30,
            [
                Measurement(one, "cup", poses(rng, seen[one]), np.diag(noise_m**2), 0.9, bool(covered[i // 5, one]))
                for one in objects
                if not lost[i // 5, one]
            ],
        )


def poses(rng: np.random.Generator, position_m: NDArray[np.float64]) -> list[Pose]:
    """Return two poses that mirror each other; the first fits better in most pictures, the second in others."""
    both = []
    for tilt, error_px in ((0.4, 0.1), (-0.4, 0.13)):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = cv2.Rodrigues(rng.normal((tilt, 0, 0), 0.02))[0], position_m
        both.append(Pose(pose, error_px * rng.uniform(0.5, 1.5)))
    return sorted(both, key=lambda each: each.error_px)


def test_objects_are_tracked_as_approved(approve: Approve) -> None:
    given = {}
    for seed in (2, 6):
        tracks = Tracks(SECOND_NS)
        given[str(seed)] = [
            {"held back": len(tracks.update(stamp_ns, found)), "listed": tracks.listed(stamp_ns)}
            for stamp_ns, found in measurements(seed)
        ]
    approve("object-tracks", given, 1e-6)


def test_markers_that_move_are_followed_as_approved(approve: Approve) -> None:
    still, detector = picture("DICT_4X4_50", 7, 0.7, 0.8), MarkerDetector({"DICT_4X4_50": range(12)})
    found = {}
    for frame in range(8):
        moved = np.array([[1, 0.004 * frame, 1.7 * frame], [-0.004 * frame, 1, -1.1 * frame]], np.float32)
        pixels = cv2.warpAffine(still, moved, still.shape[::-1], borderValue=90)
        pixels[200 + 6 * frame : 240 + 6 * frame, ::2] = 70
        found[str(frame)] = detector.detect(frame * 33_000_000, pixels)
    approve("markers-moving", found, 1e-5, besides={"covered": 3e-2, "photometric": 2e-4})
