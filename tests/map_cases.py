"""A small map, and generators of chance, for tests of maps."""

import numpy as np

from actum.som import Som


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def line_map() -> Som:
    """Three neurons in a row at 0, 1 and 10 on the number line."""
    return Som(1, 3, np.array([[0.0], [1.0], [10.0]]))
