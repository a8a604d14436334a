"""A picture is black where a covered lens would leave it so: noise does not light it, a lamp in a corner does."""

import numpy as np
import pytest

from actum.pictures import is_black


@pytest.mark.parametrize("shape", [(48, 64), (48, 64, 3), (1, 1)])
def test_noise_of_a_covered_lens_is_black(shape) -> None:
    assert is_black(np.random.default_rng(0).integers(0, 6, shape, dtype=np.uint8))
    assert not is_black(np.full(shape, 40, np.uint8))


def test_a_lamp_in_a_corner_is_seen() -> None:
    pixels = np.zeros((480, 640, 3), np.uint8)
    pixels[:80, :80] = 200
    assert not is_black(pixels)
