"""Small markers by their whole pattern: exact where edges are not, and not misled by a finger."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from marker_tracker.detection.alignment import align, align_by_similarity
from marker_tracker.detection.decoding import Candidates, decode
from marker_tracker.detection.families import family

FAMILY = family("DICT_4X4_50")
PATTERN = FAMILY.patterns[3]
FINE = 8
BLACK, WHITE, SKIN = 30, 225, 165


def drawn(corners_px, blur_px=0.6, finger=0.0, noise=0.0):
    """A marker on its white card; a finger covers this part of its height from above."""
    cell = 40
    card = np.kron(np.where(np.pad(PATTERN, 1, constant_values=True), WHITE, BLACK), np.ones((cell, cell)))
    card[: round(cell * (1 + finger * len(PATTERN))), 2 * cell : -3 * cell] = SKIN if finger else WHITE
    side = len(PATTERN) * cell
    flat = np.array([[0, 0], [side, 0], [side, side], [0, side]], dtype=np.float32) + cell - 0.5
    there = (np.asarray(corners_px) + 0.5) * FINE - 0.5
    mapping = cv2.getPerspectiveTransform(flat, there.astype(np.float32))
    size = (64 * FINE, 64 * FINE)
    fine = cv2.warpPerspective(
        card.astype(np.float32), mapping, size, borderMode=cv2.BORDER_CONSTANT, borderValue=WHITE
    )
    pixels = cv2.GaussianBlur(cv2.resize(fine, (64, 64), interpolation=cv2.INTER_AREA), (0, 0), blur_px)
    grain = np.random.default_rng(0).normal(0.0, noise, pixels.shape)
    return np.clip(pixels + grain, 0, 255).astype(np.uint8)


def square(side_px, x=32.0, y=32.0, turn=0.0):
    ring = side_px / np.sqrt(2) * np.exp(1j * (turn + np.pi / 4 * np.array([-3, -1, 1, 3])))
    return np.column_stack([x + ring.real, y + ring.imag])


def off_px(found, truth):
    return float(np.linalg.norm(found.corners_px[0] - truth, axis=1).max())


@settings(max_examples=30)
@given(
    st.floats(16, 36), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(0.45, 1.2),
    st.integers(0, 99),
)  # fmt: skip
def test_corners_are_found_to_a_fraction_of_a_pixel_whatever_the_size_place_turn_and_blur(
    side_px, x, y, turn, blur_px, seed
) -> None:
    truth = square(side_px, 32 + x, 32 + y, turn)
    start = truth + np.random.default_rng(seed).uniform(-0.4, 0.4, (4, 2))
    found = align(drawn(truth, blur_px, noise=2.0), start[None], PATTERN[None])
    assert off_px(found, truth) < 0.2
    assert found.covered[0] < 0.01


@pytest.mark.parametrize("finger", [0.1, 0.2, 0.3])
def test_what_a_finger_covers_is_told_and_misleads_little(finger) -> None:
    truth = square(24.0)
    found = align_by_similarity(drawn(truth, finger=finger), (truth + np.array([0.5, -0.5]))[None], PATTERN[None])
    assert off_px(found, truth) < 0.2
    assert 0.02 < found.covered[0] < 0.5


def test_alignment_by_similarity_is_by_shift_rotation_and_scale_alone() -> None:
    truth, start = square(25.0, 32.3, 31.8, 0.05), square(24.0)
    found = align_by_similarity(drawn(truth), start[None], PATTERN[None]).corners_px[0]
    sides = np.linalg.norm(found - np.roll(found, 1, axis=0), axis=1)
    assert np.ptp(sides) < 0.05
    assert np.abs(found - truth).max() < 0.1


def test_several_at_once_are_as_each_alone() -> None:
    pixels, starts = drawn(square(24.0)), np.stack([square(24.0) + 0.3, square(24.0) - 0.2])
    both = align(pixels, starts, np.stack([PATTERN, PATTERN])).corners_px
    alone = [align(pixels, start[None], PATTERN[None]).corners_px[0] for start in starts]
    assert np.allclose(both, alone, atol=1e-6)


@pytest.mark.parametrize(("side_px", "small"), [(30.0, True), (60.0, False)])
def test_markers_are_aligned_if_their_cells_are_small(side_px, small) -> None:
    rough = square(side_px)[None]
    (marker,) = decode(drawn(square(side_px)), [Candidates(FAMILY, rough, rough)])
    assert (marker.start is not None) == small


@pytest.mark.parametrize("number", [0, 17, 49])
def test_the_patterns_of_a_family_are_as_printed(number) -> None:
    picture = cv2.aruco.generateImageMarker(FAMILY.dictionary, number, FAMILY.cells + 2)
    assert np.array_equal(FAMILY.patterns[number], picture > 0)


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.floats(4, 60), st.booleans())
def test_whatever_an_image_shows_corners_stay_near(seed, side_px, flat) -> None:
    chance = np.random.default_rng(seed)
    level = int(chance.integers(256))
    pixels = np.full((64, 64), level, np.uint8) if flat else chance.integers(0, 256, (64, 64), dtype=np.uint8)
    start = (square(side_px) + chance.normal(0.0, side_px / 6, (4, 2)))[None]
    for aligned in (align, align_by_similarity):
        found = aligned(pixels, start, PATTERN[None])
        assert np.abs(found.corners_px - start).max() <= 1.5
        assert 0 <= found.covered[0] <= 1
