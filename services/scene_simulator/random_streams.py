"""Seeded random numbers: an independent stream for each purpose, so that draws for one do not change another's."""

import zlib

import numpy as np

from actum.arrays import Array

CUT = 2.0
"""Standard deviations at which normal distributions are clipped: avoids impossible people."""


def random_stream(purpose: str, *seeds: int) -> np.random.Generator:
    """Open the random stream of one purpose; the same arguments always give the same numbers."""
    return np.random.default_rng([zlib.crc32(purpose.encode()), *seeds])


def draw_normal(rng: np.random.Generator, mean_sd: tuple[float, float]) -> float:
    """Draw from a normal distribution (mean, standard deviation), clipped at two standard deviations."""
    mean, sd = mean_sd
    return mean + sd * float(np.clip(rng.standard_normal(), -CUT, CUT))


def draw_normals(rng: np.random.Generator, sd: float, count: int) -> Array:
    """Draw (count,) from a normal distribution of mean zero, clipped at two standard deviations."""
    return sd * np.clip(rng.standard_normal(count), -CUT, CUT)


def draw_uniform(rng: np.random.Generator, low_high: tuple[float, float]) -> float:
    """Draw from a uniform range (low, high)."""
    return float(rng.uniform(*low_high))
