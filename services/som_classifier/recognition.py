"""The answer of a model."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Recognition:
    """The action recognised in a segment's frames so far.

    Attributes:
        label: the action whose neuron is most active.
        confidence: in the label, within [0, 1]; each kind of model defines it.
        activations: every neuron's cosine by action.
        part: the body part that moves most.
        familiarity: how similar the segment is to what was trained; None where the model cannot tell.
        unknown: whether its familiarity is so low that the action may be none of those trained.
    """

    label: str
    confidence: float
    activations: dict[str, float]
    part: str
    familiarity: float | None = None
    unknown: bool = False
