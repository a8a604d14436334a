"""Seeded chance: one independent stream per purpose, so that no part of the scene disturbs another's draws."""

import zlib

import numpy as np

CUT = 2.0


def stream(purpose: str, *seeds: int) -> np.random.Generator:
    """Open the random stream of one purpose; the same arguments always give the same numbers."""
    return np.random.default_rng([zlib.crc32(purpose.encode()), *seeds])


def normal(rng: np.random.Generator, mean_sd: tuple[float, float]) -> float:
    """Draw from a normal distribution, cut at two standard deviations."""
    mean, sd = mean_sd
    return mean + sd * float(np.clip(rng.standard_normal(), -CUT, CUT))


def normals(rng: np.random.Generator, sd: float, count: int) -> np.ndarray:
    """Draw `count` numbers of mean zero, cut at two standard deviations."""
    return sd * np.clip(rng.standard_normal(count), -CUT, CUT)


def uniform(rng: np.random.Generator, low_high: tuple[float, float]) -> float:
    """Draw from a uniform range."""
    return float(rng.uniform(*low_high))
