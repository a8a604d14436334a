"""What a model answers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Recognition:
    """What a segment's frames so far are taken to be.

    Attributes:
        label: the action whose neuron answers most.
        confidence: how sure that is, within [0, 1]; what it means is the model's to say.
        activations: every neuron's cosine by action.
        part: the body part that moves most.
        familiarity: how much the segment is like what was trained; None where the model cannot tell.
        unknown: whether it is so unfamiliar that the action may be none of those trained.
    """

    label: str
    confidence: float
    activations: dict[str, float]
    part: str
    familiarity: float | None = None
    unknown: bool = False
