"""What many people in one stream cost preprocessor and classifier, the search on, on one core."""

import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from benchmarks.throughput import Stage

from actum.codec import encode
from actum.messages import Skeleton
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.group import MOST_PEOPLE, Group
from scene_simulator.programme import balanced_programme
from som_classifier.model import Model
from som_classifier.node import SomClassifier

FRAMES = 600
"""Twenty seconds: each action is done, and each decision of the search has come up."""
FRAME_S = 1 / 30
"""Between two frames."""


class Load(NamedTuple):
    """What so many people cost: the share of a core at 30 frames a second, and a decision's median and tail (ms)."""

    people: int
    core: float
    p50_ms: float
    p99_ms: float


def load(people: int, model: Model) -> Load:
    """Feed frames of so many people as fast as they are taken; a decision is on one posture, codec included."""
    preprocessor, classifier = Stage(PosePreprocessor(PoseSettings.defaults())), Stage(SomClassifier(model))
    took_s, began_s = [], time.perf_counter()
    for skeleton in crowded(people):
        for posture in preprocessor.step(encode(skeleton)):
            decision_s = time.perf_counter()
            classifier.step(posture)
            took_s.append(time.perf_counter() - decision_s)
    elapsed_s = time.perf_counter() - began_s
    p50, p99 = 1e3 * np.percentile(took_s, [50, 99])
    return Load(people, elapsed_s / (FRAMES * FRAME_S), float(p50), float(p99))


def crowded(people: int) -> Iterator[Skeleton]:
    """Yield skeletons of so many people: groups of four that do different things, at each other's places."""
    groups = [frames_of(seed) for seed in range(-(-people // MOST_PEOPLE))]
    for number in range(FRAMES):
        agents = [agent for group in groups for agent in group[number].agents][:people]
        renumbered = [agent.model_copy(update={"agent": n}) for n, agent in enumerate(agents, start=1)]
        yield groups[0][number].model_copy(update={"agents": renumbered})


def frames_of(seed: int) -> Sequence[Skeleton]:
    """Return the skeletons of one group."""
    programmes = [balanced_programme(4, MOST_PEOPLE * seed + k) for k in range(MOST_PEOPLE)]
    skeletons = (m for frame in Group(programmes, seed=seed).frames() for m in frame if isinstance(m, Skeleton))
    return [next(skeletons) for _ in range(FRAMES)]
