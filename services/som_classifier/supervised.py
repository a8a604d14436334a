"""The third layer: one neuron per action on the second map's activity (paper, section 2.1)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from actum.arrays import Array, Floats, Indices
from actum.core import steps


@dataclass(frozen=True, eq=False)
class SupervisedLayer:
    """Neurons that answer with the cosine between the input and their weights.

    Attributes:
        weights: (actions, inputs), rows of unit length in single or double precision, read-only.

    Raises:
        ValueError: the weights are of another shape or not of unit length.
    """

    weights: Floats

    def __post_init__(self) -> None:
        weights = np.array(self.weights, order="C")
        if weights.ndim != 2 or not np.allclose(np.linalg.norm(weights, axis=1), 1.0):
            raise ValueError(
                f"the weights (shape {weights.shape}) are not a matrix of unit vectors: give one row of Euclidean norm "
                "1 for each action"
            )
        weights.setflags(write=False)
        object.__setattr__(self, "weights", weights)

    @classmethod
    def random(cls, actions: int, inputs: int, rng: "np.random.Generator") -> "SupervisedLayer":
        """Make an untrained layer: weights drawn from U(0, 1), then made unit length."""
        weights = rng.random((actions, inputs))
        return cls(weights / np.linalg.norm(weights, axis=1, keepdims=True))

    @classmethod
    def of_means(cls, inputs: Array, targets: Indices, actions: int) -> "SupervisedLayer":
        """Make a layer whose weights are the mean of the inputs of each action, all equal where it has no input.

        Args:
            inputs: (n, inputs).
            targets: (n,), the action of each input.
            actions: how many there are.
        """
        sums: Array = np.eye(actions)[targets].T @ inputs
        sums[~sums.any(axis=1)] = 1.0
        return cls(sums / np.linalg.norm(sums, axis=1, keepdims=True))

    def cosines(self, x: Floats) -> Floats:
        """Return each neuron's activity x·w / ‖x‖‖w‖ for x (inputs,), shape (actions,)."""
        cosines: Floats = self.weights.dot(x) / np.sqrt(x.dot(x))
        return cosines

    def train(
        self,
        inputs: Array,
        targets: Indices,
        beta: float,
        epochs: int,
        rng: "np.random.Generator",
        report: Callable[[int, int], None] = lambda done, total: None,
    ) -> "SupervisedLayer":
        """Return the layer after showing it every row of (n, inputs) once per epoch, in random order.

        Args:
            inputs: (n, inputs).
            targets: (n,), the index of the neuron that is to answer 1; the others are to answer 0.
            beta: adaptation strength.
            epochs: how often every row is shown.
            rng: draws the order.
            report: called with the epochs done and those in all.
        """
        weights = self.weights.astype(np.float64)
        unit_inputs = inputs / np.linalg.norm(inputs, axis=1, keepdims=True)
        desired = np.eye(len(weights))[targets]
        for epoch in range(epochs):
            order = rng.permutation(len(inputs))
            if steps is not None:
                steps.adapted(weights, unit_inputs, targets.astype(np.int64), order, beta)
            else:
                for index in order:
                    adapt(weights, unit_inputs[index], desired[index], beta)
            report(epoch + 1, epochs)
        return SupervisedLayer(weights)


def adapt(weights: Array, x: Array, desired: Array, beta: float) -> None:
    """Apply the delta rule w += β x (d − y) in place and make the weights unit length again.

    The paper prints [y − d], which drives each neuron away from its desired answer.

    Args:
        weights: (actions, inputs), rows of unit length.
        x: (inputs,), of unit length.
        desired: (actions,), d.
        beta: adaptation strength.
    """
    error = desired - weights @ x
    weights += np.multiply.outer(beta * error, x)
    weights /= np.sqrt(np.einsum("ij,ij->i", weights, weights))[:, None]
