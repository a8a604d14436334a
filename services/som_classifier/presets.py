"""The recogniser's parameters, in named sets."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from actum.som import Schedule


@dataclass(frozen=True)
class MapPlan:
    """A map's size and how it is trained."""

    rows: int
    cols: int
    steps: int
    schedule: Schedule


@dataclass(frozen=True)
class Preset:
    """Everything that a training depends on beside its samples and its seed.

    Attributes:
        part: the body part attended to, or None for the one that moves most.
        relative_contrast: the second map's contrast in units of the training vectors' median squared distance
            to their nearest neighbour.
        beta: adaptation strength of the third layer.
        epochs: how often the third layer is shown every training vector.
    """

    name: str
    part: str | None
    layer1: MapPlan
    layer2: MapPlan
    relative_contrast: float
    beta: float
    epochs: int


PAPER = Preset(
    name="paper",
    part=None,
    layer1=MapPlan(30, 30, 100_000, Schedule(alpha=(0.1, 0.01), radius=(15.0, 2.0))),
    layer2=MapPlan(35, 35, 30_000, Schedule(alpha=(0.5, 0.02), radius=(17.5, 0.5))),
    relative_contrast=0.15,
    beta=0.35,
    epochs=50,
)
"""The architecture of Gharaee, Gärdenfors and Johnsson (2017).

What the paper leaves open was chosen by cross-validation on training samples only: people 1, 3, 5, 7 and 9 of MSR
Action3D, and the demo's simulated training set.
"""

PRESETS: Mapping[str, Preset] = MappingProxyType({preset.name: preset for preset in (PAPER,)})
