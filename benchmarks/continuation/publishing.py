"""What it costs a classifier to publish continuations, beside what it does anyway."""

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.codec import encode
from actum.messages import Posture
from som_classifier.model import Model
from som_classifier.node import SomClassifier

ROUNDS = 8
"""Replays with and without, in turns; of each posture the fastest ones count: others use the cores, too."""


def published_ms(model: Model, postures: Sequence[Posture]) -> tuple[float, float]:
    """Return how much longer a posture takes where somebody listens (ms), on average and the slowest hundredth."""
    times_s = [[_times_s(model, postures, is_demanded) for is_demanded in (True, False)] for _ in range(ROUNDS)]
    demanded, alone = np.min(times_s, axis=0)
    return 1000 * float((demanded - alone).mean()), 1000 * float(np.quantile(demanded - alone, 0.99))


def _times_s(model: Model, postures: Sequence[Posture], is_demanded: bool) -> NDArray[np.float64]:
    """Replay postures; return how long each of them takes (s), up to the bytes that are put."""
    node, times_s = SomClassifier(model), []
    node.is_demanded = is_demanded
    for posture in postures:
        began_s = time.perf_counter()
        for message in node.handle(posture):
            encode(message)
        times_s.append(time.perf_counter() - began_s)
    return np.array(times_s)
