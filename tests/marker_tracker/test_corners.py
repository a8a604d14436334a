"""Corners of drawn squares are found where they were drawn, without bias, whatever rough corners they start from."""

from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from marker_tracker.detection.corners import refine

SUPERSAMPLING = 6
SIZE = 140
UNIT = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float) / 2


def drawn(corners_px: Any, blur_px: float, noise: float) -> Any:
    """A black square on white paper, each pixel the mean of what it covers."""
    y, x = (np.indices((SIZE * SUPERSAMPLING,) * 2) + 0.5) / SUPERSAMPLING - 0.5
    inside = np.ones(x.shape, dtype=bool)
    for (ax, ay), (bx, by) in zip(corners_px, np.roll(corners_px, -1, axis=0), strict=True):
        inside &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0
    covered = inside.reshape(SIZE, SUPERSAMPLING, SIZE, SUPERSAMPLING).mean(axis=(1, 3))
    image = 225 - 195 * covered
    blurred = cv2.GaussianBlur(image, (0, 0), blur_px)
    noisy = blurred + np.random.default_rng(0).normal(0, noise, blurred.shape)
    return np.clip(np.round(noisy), 0, 255).astype(np.uint8)


def square(side_px: float, angle: float, squeezed: float, centre: float = 69.6) -> Any:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return side_px * UNIT @ turn.T * [squeezed, 1.0] + [centre, centre + 0.3]


def outward(refined: Any, corners: Any) -> float:
    radius = corners - corners.mean(axis=0)
    return float(((refined - corners) * radius / np.linalg.norm(radius, axis=1, keepdims=True)).sum(axis=1).mean())


@pytest.mark.parametrize("side_px", [20, 26, 40, 80])
def test_squares_come_out_neither_larger_nor_smaller(side_px) -> None:
    squares = [square(side_px, angle, 0.9) for angle in np.linspace(0.05, 1.5, 12)]
    off = [outward(refine(drawn(q, 0.7, 1.0), (0.97 * (q - 70) + 70)[None])[0], q) for q in squares]
    assert abs(np.mean(off)) < 0.03


@settings(max_examples=40)
@given(st.floats(24, 85), st.floats(0, np.pi), st.floats(0.5, 1.0), st.integers(0, 2**32 - 1))
def test_rough_corners_lead_to_the_same_exact_ones(side_px, angle, squeezed, seed) -> None:
    corners = square(side_px, angle, squeezed)
    rough = corners + np.random.default_rng(seed).uniform(-0.9, 0.9, (4, 2))
    refined = refine(drawn(corners, 0.7, 0.0), rough[None])[0]
    assert np.abs(refined - corners).max() < 0.25


@settings(max_examples=100)
@given(st.lists(st.floats(-50, 210), min_size=8, max_size=8), st.integers(0, 2**32 - 1))
def test_corners_never_diverge_nor_become_nan(numbers, seed) -> None:
    quad = np.reshape(numbers, (1, 4, 2))
    pixels = np.random.default_rng(seed).integers(0, 256, (SIZE, SIZE), dtype=np.uint8)
    shortest = np.linalg.norm(quad[0] - np.roll(quad[0], 1, axis=0), axis=1).min()
    assert np.abs(refine(pixels, quad) - quad).max() <= max(2.0, 0.2 * shortest) + 2.0


def test_a_plain_wall_leaves_corners_where_they_were() -> None:
    quad = square(50, 0.2, 1.0)[None]
    assert np.allclose(refine(np.full((SIZE, SIZE), 128, dtype=np.uint8), quad), quad, atol=1e-9)
