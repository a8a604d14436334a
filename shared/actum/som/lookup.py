"""Finds the nearest units of one vector or many, by squared distances less the term |x|² that all units share."""

from collections.abc import Iterator
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import blas
from actum.som.inputs import is_complete

Array = NDArray[Any]
Scores = tuple[slice, Array]
"""A slice of the vectors that are scored, and their scores, (rows, stride)."""


class Lookup:
    """A map's weights, laid out for comparing vectors with all of them.

    A score is half the squared distance less ½|x|², ½|w|² − w·x: the same order and the same differences as the
    squared distances. Both x and w are taken relative to a point amid the weights; far from zero the two terms would
    cancel, in float32 down to nothing. Where components of x are missing (NaN), a score counts the others only and is
    scaled up by dim / known.

    Attributes:
        centre: (dim,), the point amid the weights.
        slopes: (dim, nodes), −w relative to the centre, by which an input relative to the centre is multiplied.
        half_norms2: (nodes,), ½|w|² relative to the centre, which is added to that product.
    """

    def __init__(self, weights: Array) -> None:
        self.nodes, self.dim = weights.shape
        self.dtype = weights.dtype
        self.centre = _round_centre(weights).astype(self.dtype)
        self._shape = (self.dim,)
        self._stride = blas.stride(self.nodes, self.dtype)
        centred = (weights - self.centre).T
        self._score_matrix = np.zeros((self.dim + 1, self._stride), self.dtype)
        self._score_matrix[:-1, : self.nodes] = -centred
        self._score_matrix[-1] = np.finfo(self.dtype).max / 2
        self._score_matrix[-1, : self.nodes] = 0.5 * np.square(centred).sum(axis=0)
        self._slopes, self._half_norms2 = self._score_matrix[:-1], self._score_matrix[-1]
        self.slopes, self.half_norms2 = self._slopes[:, : self.nodes], self._half_norms2[: self.nodes]

    def score(self, x: Array) -> Array:
        """Score one vector (dim,) against all units, shape (stride,) with large values after the last unit.

        Raises:
            ValueError: the vector has another length, an infinite component, or no known one.
        """
        if x.shape != self._shape:
            raise ValueError(
                f"the vector has the shape {x.shape}, but the map has {self.dim} components: give a vector of the "
                f"shape ({self.dim},)"
            )
        centred = x - self.centre
        if centred.dtype != self.dtype:
            centred = centred.astype(self.dtype)
        if not isfinite(centred.dot(centred)):
            _, rows = next(self.scores(x[None]))
            return np.ravel(rows)
        scores: Array = blas.row_matmul(centred, self._slopes)
        np.add(scores, self._half_norms2, scores)
        return scores

    def scores(self, vectors: Array) -> Iterator[Scores]:
        """Score the rows of (n, dim) in chunks: a slice of them and (rows of it, stride), valid until the next one.

        Raises:
            ValueError: the rows have another length, an infinite component, or no known one.
        """
        if vectors.ndim != 2 or vectors.shape[1] != self.dim:
            raise ValueError(
                f"the vectors have the shape {vectors.shape}, but the map has {self.dim} components: give an array of "
                f"the shape (number of vectors, {self.dim})"
            )
        return self._known_scores(vectors) if is_complete(vectors) else self._partial_scores(vectors)

    def winners(self, vectors: Array) -> NDArray[np.intp]:
        """Find the unit of the lowest score for each row of (n, dim), the first of equals. Shape (n,)."""
        winners = np.empty(len(vectors), np.intp)
        for chunk, scores in self.scores(vectors):
            np.argmin(scores, axis=1, out=winners[chunk])
        return winners

    def _known_scores(self, vectors: Array) -> Iterator[Scores]:
        for chunk, inputs, out in self._buffers(vectors, self.dim + 1):
            inputs[:, -1] = 1
            rows = chunk.stop - chunk.start
            np.subtract(vectors[chunk], self.centre, out=inputs[:rows, :-1], casting="same_kind")
            blas.matmul_into(inputs, self._score_matrix, out)
            yield chunk, out[:rows]

    def _partial_scores(self, vectors: Array) -> Iterator[Scores]:
        matrix = np.concatenate([self._slopes, 0.5 * np.square(self._slopes)])
        for chunk, inputs, out in self._buffers(vectors, 2 * self.dim):
            rows = chunk.stop - chunk.start
            known = ~np.isnan(vectors[chunk])
            inputs[:rows, : self.dim] = np.where(known, vectors[chunk] - self.centre, 0)
            inputs[:rows, self.dim :] = known
            blas.matmul_into(inputs, matrix, out)
            out[:rows] *= (self.dim / known.sum(axis=1, keepdims=True)).astype(self.dtype)
            out[:, self.nodes :] = self._half_norms2[self.nodes :]
            yield chunk, out[:rows]

    def _buffers(self, vectors: Array, width: int) -> Iterator[tuple[slice, Array, Array]]:
        """Yield for each chunk of rows a zeroed array for its inputs and one for its scores, rows padded for BLAS."""
        inputs = np.zeros((blas.CHUNK_ROWS, width), self.dtype)
        out = np.empty((blas.CHUNK_ROWS, self._stride), self.dtype)
        for start in range(0, len(vectors), blas.CHUNK_ROWS):
            chunk = slice(start, min(start + blas.CHUNK_ROWS, len(vectors)))
            padded = blas.padded_width(chunk.stop - start)
            inputs[chunk.stop - start : padded] = 0
            yield chunk, inputs[:padded], out[:padded]


def _round_centre(weights: Array) -> NDArray[np.float64]:
    """Return the mean of weights (nodes, dim), rounded to multiples of a power of two near their spread, (dim,).

    Subtracting a round number is exact for round weights, so that equal distances stay equal.
    """
    mean = weights.mean(axis=0, dtype=np.float64)
    spread = np.abs(weights - mean).max()
    if spread == 0:
        return np.asarray(mean)
    step = 2.0 ** np.floor(np.log2(spread))
    rounded: NDArray[np.float64] = np.round(mean / step) * step
    return rounded
