"""How complete each action is within a window: linear heads on the window's pyramid vector.

A head is trained to answer 1 for a window that is the whole action, 0 for one that overlaps it little or not at all,
and linearly in between: `completeness_of_iou`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats
from actum.som.blas import row_matmul

NONE_BELOW_IOU = 0.25
"""Overlap (intersection over union) up to which a window counts as none of an action: chance overlaps reach it."""
WHOLE_FROM_IOU = 0.85
"""Overlap from which a window counts as the whole action: nobody marks bounds more exactly."""


def completeness_of_iou(iou: Floats) -> Floats:
    """Return the completeness that a head is to answer for overlaps (…), same shape, within [0, 1]."""
    share = (iou - NONE_BELOW_IOU) / (WHOLE_FROM_IOU - NONE_BELOW_IOU)
    completeness: Floats = np.clip(share, 0.0, 1.0)
    return completeness


def iou_of_completeness(completeness: float) -> float:
    """Return the overlap (0 to 1) that a head's answer stands for: of a beginning, how much of the action is done."""
    return min(max(NONE_BELOW_IOU + completeness * (WHOLE_FROM_IOU - NONE_BELOW_IOU), 0.0), 1.0)


@dataclass(frozen=True, eq=False)
class CompletenessHeads:
    """One linear head for each action.

    Attributes:
        axes: (inputs, actions), float32.
        offsets: (actions,), float32.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]

    def completeness(self, vector: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return each head's answer to a pyramid vector (inputs,): about 0 to 1, shape (actions,)."""
        completeness: NDArray[np.float32] = row_matmul(vector, self.axes) + self.offsets
        return completeness
