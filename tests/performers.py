"""Synthetic people who do labelled actions one after the other, and a preset small enough for tests."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from actum.messages import Segment, Skeleton
from actum.som import Schedule
from people import FRAME_NS, STANDING, skeleton
from som_classifier.attention import MOVING, PostureInput
from som_classifier.presets import PYRAMID, BodyVariation, MapTraining, PaperPreset

FRAMES = 20
PAUSE_FRAMES = 5

TINY = replace(
    PYRAMID,
    name="tiny",
    units=(6, 6),
    unit_epochs=4,
    unit_radius=(2.0, 0.6),
    relative_contrast=0.5,
    others=BodyVariation(1, build_sd=0.1, tempo=1.0),
    others_of_few=BodyVariation(2, build_sd=0.1, tempo=0.5),
    few_people=1,
    stages=((0.3, 0.5), (0.7,), (1.0,)),
    fewest_scores=200,
    concepts=(8, 8),
    concept_epochs=6,
    concept_radius=(3.0, 0.8),
    epochs=5,
    convolutions=replace(PYRAMID.convolutions, biases=1, verifier_weight=1.0),
    background=20,
    prior=replace(PYRAMID.prior, threshold=0.3),
    spotting=replace(
        PYRAMID.spotting,
        windows=4,
        shortest_quantile=0.1,
        most_windows=600,
        common_shares=(0.0, 0.3),
        folds=2,
        thresholds=(0.3, 0.45, 0.6, 0.75),
    ),
)

FALLING = Schedule(alpha=(0.5, 0.05), radius=(5.0, 0.6))
TINY_PAPER = PaperPreset(
    name="tiny paper",
    posture=PostureInput(axes="upright", origin="hips", attention=MOVING),
    layer1=MapTraining(10, 10, 4000, FALLING),
    layer2=MapTraining(8, 8, 2000, FALLING),
    centre_contrast=0.3,
    relative_contrast=0.15,
    beta=0.35,
    epochs=20,
)
TINY_OF_EACH_KIND = (TINY, TINY_PAPER)

HAND_PATHS = {
    "lift": (8, np.array([0.05, -0.50, -0.10])),
    "push": (8, np.array([0.00, -0.10, -0.50])),
    "swing": (5, np.array([0.40, -0.30, -0.10])),
}
"""Per action the hand that moves and how far (m, camera frame)."""


def posed(action: str, phase: float, height: float, rng: np.random.Generator) -> NDArray[np.float64]:
    hand, reach_m = HAND_PATHS[action]
    joints = STANDING + rng.normal(0, 0.0005, (15, 3))
    joints[hand] += phase * reach_m
    joints[hand - 1] += 0.5 * phase * reach_m
    return joints * height


def performance(
    actions: list[str], height: float = 1.0, seed: int = 0, frames: int = FRAMES
) -> tuple[list[Skeleton], list[Segment]]:
    """One action after the other with a rest between, and the marks around each."""
    rng = np.random.default_rng(seed)
    skeletons: list[Skeleton] = []
    marks: list[Segment] = []
    for number, action in enumerate(actions):
        first = len(skeletons)
        phases = [*np.linspace(0, 1, frames), *[0.0] * PAUSE_FRAMES]
        for phase in phases:
            skeletons.append(skeleton(len(skeletons) * FRAME_NS, posed(action, phase, height, rng)))
        marks.append(mark("start", first * FRAME_NS, f"{number}", action))
        marks.append(mark("end", (first + frames - 1) * FRAME_NS, f"{number}"))
    return skeletons, marks


def mark(kind: str, stamp_ns: int, segment_id: str, label: str | None = None, sensor: str = "kinect0") -> Segment:
    return Segment.model_validate(
        {"sensor": sensor, "kind": kind, "segment_id": segment_id, "stamp_ns": stamp_ns, "label": label}
    )
