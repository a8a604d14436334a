"""A template is found again wherever it has gone, turned and grown, also where something lies on a part of it."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from marker_tracker.occlusion.crop import blurred
from marker_tracker.occlusion.registration import Similarity, Template

SIZE = 96
NOISE = cv2.GaussianBlur(np.random.default_rng(0).normal(0.0, 1.0, (4 * SIZE, 4 * SIZE)), (0, 0), 10)
FINE = np.clip(128 + 40 * NOISE / NOISE.std(), 0, 255)
MIDDLE = 47.5 + 47.5j


def drawn(place: Similarity, gain=1.0, noise=0.0, covered=0.0):
    """A texture that a similarity has moved from an image's middle, with something flat over its left part."""
    turn, middle = place.scale_rotation / 4, place.centre_px
    shift = middle - turn * (4 * SIZE - 1) / 2 * (1 + 1j)
    there = np.array([[turn.real, -turn.imag, shift.real], [turn.imag, turn.real, shift.imag]])
    image = cv2.warpAffine(FINE, there, (SIZE, SIZE), flags=cv2.INTER_AREA, borderMode=cv2.BORDER_REFLECT)
    if covered:
        image[:, : round(middle.real - 20 + 40 * covered)] = 90
    grain = np.random.default_rng(1).normal(0.0, noise, image.shape)
    return blurred(np.clip(gain * image + grain, 0, 255).astype(np.uint8))


TEMPLATE = Template(drawn(Similarity(MIDDLE)), MIDDLE, 20.0)


@settings(max_examples=40)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.9, 1.1), st.floats(-0.15, 0.15), st.floats(0.8, 1.1))
def test_it_is_found_where_it_is_whatever_its_size_turn_and_light(x, y, size, angle, gain) -> None:
    truth = Similarity(MIDDLE + complex(x, y), size * np.exp(1j * angle))
    found, correlation = TEMPLATE.register(drawn(truth, gain, noise=2.0), Similarity(MIDDLE))
    assert abs(found.centre_px - truth.centre_px) < 0.15
    assert abs(found.scale_rotation / truth.scale_rotation - 1) < 0.01
    assert correlation > 0.95


@pytest.mark.parametrize("covered", [0.15, 0.3])
def test_what_lies_on_a_part_of_it_misleads_little(covered) -> None:
    truth = Similarity(MIDDLE + 1.5 - 1j, 0.95)
    found, correlation = TEMPLATE.register(drawn(truth, covered=covered), Similarity(MIDDLE))
    assert abs(found.centre_px - truth.centre_px) < 0.3
    assert abs(found.scale_rotation - 0.95) < 0.02
    assert correlation > 0.9


def test_far_away_it_is_found_roughly_first() -> None:
    window = drawn(Similarity(MIDDLE + 14 - 11j))
    assert abs(TEMPLATE.search(window) - (MIDDLE + 14 - 11j)) < 1


def test_where_it_is_not_nothing_correlates() -> None:
    elsewhere = np.random.default_rng(5).integers(0, 255, (SIZE, SIZE), dtype=np.uint8)
    assert TEMPLATE.register(blurred(elsewhere), Similarity(MIDDLE))[1] < 0.6
    assert TEMPLATE.register(np.full((SIZE, SIZE), 90.0), Similarity(MIDDLE))[1] < 0.6
