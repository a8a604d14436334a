"""The head that all actions have in common, and how much of it each action's own head takes over.

Own heads see few windows of their action. The common head learns from all windows what distinguishes any action from
none: where actions are alike, each head is better as a mixture of both.
"""

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from som_classifier.spotting.spotting_model import CompletenessHeads


def with_common(completeness: Array) -> Array:
    """Append to the completeness of each action (n, actions) that of any action: (n, actions + 1)."""
    return np.column_stack([completeness, completeness.max(axis=1)])


def mixed(answers: NDArray[np.float32], share: float) -> NDArray[np.float32]:
    """Return the own heads' answers, mixed with a share of the common head's: (…, actions) of (…, actions + 1)."""
    mixture: NDArray[np.float32] = (1 - share) * answers[..., :-1] + share * answers[..., -1:]
    return mixture.astype(np.float32)


def mixed_heads(heads: CompletenessHeads, share: float) -> CompletenessHeads:
    """Return heads (actions) that answer what own heads and the common one (actions + 1) answer, mixed."""
    return CompletenessHeads(mixed(heads.axes, share), mixed(heads.offsets, share))
