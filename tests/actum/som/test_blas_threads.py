"""One BLAS thread or two: the same to the bit."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import hashlib
import numpy as np
from actum.som import Schedule, Som
for dtype in (np.float32, np.float64):
    for rows, cols, dim in ((30, 30, 9), (30, 31, 45), (35, 35, 60), (31, 30, 700)):
        vectors = np.random.default_rng(dim).normal(size=(777, dim)).astype(dtype)
        start = Som.linear(rows, cols, vectors)
        batch = start.train_batch(vectors, 3, (5.0, 1.0))
        sequential = batch.train(vectors, 50, Schedule((0.1, 0.02), (2.0, 0.7)), np.random.default_rng(1))
        gappy = np.where(np.random.default_rng(2).random(vectors.shape) < 0.1, np.nan, vectors)
        for found in (
            start.weights,
            batch.weights,
            sequential.weights,
            batch.bmus(vectors),
            batch.excess2s(vectors),
            batch.excess2s(vectors[:5]),
            batch.excess2s(gappy[:130]),
            np.stack([batch.excess2(x) for x in vectors[:20]]),
        ):
            print(np.dtype(dtype).name, rows, cols, dim, hashlib.sha256(found.tobytes()).hexdigest())
"""


def output(threads: int) -> list[str]:
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": str(threads)}
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


@pytest.mark.long
def test_one_and_two_threads_give_the_same_maps_and_distances() -> None:
    with_one = output(1)
    assert len(with_one) == 64
    assert with_one == output(2)
