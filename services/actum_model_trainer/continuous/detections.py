"""What was found in recordings without marks, what was done in them, and when anybody was seen; as JSON."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from statistics import median_high
from typing import Any


@dataclass(frozen=True)
class Interval:
    """A span of one person's time.

    Attributes:
        file: the recording's path; with the sensor behind it where the recording holds several.
        agent: whose time it is; 0 for an action that was done while nobody was seen.
        start_ns: stamp of its first frame.
        end_ns: stamp of its last frame, which belongs to it.
    """

    file: str
    agent: int
    start_ns: int
    end_ns: int


@dataclass(frozen=True)
class Detection(Interval):
    """An action that was found.

    Attributes:
        decided_ns: stamp of the newest posture when the answer came.
        confidence: of the label, 0 to 1.
        point_ns: the action point that it claims, a single instant of the action; None for its middle.
        familiarity: the probability that this is a true instance of the label, as the classifier publishes it; None
            where the confidence says that.
    """

    decided_ns: int
    label: str
    confidence: float
    point_ns: int | None = None
    familiarity: float | None = None

    @property
    def sureness(self) -> float:
        """By what detections are ranked: familiarity if there is one, otherwise confidence.

        Our confidence is the probability of the label if an action was done at all, so it ranks no false alarms.
        """
        return self.confidence if self.familiarity is None else self.familiarity

    @property
    def claimed_point_ns(self) -> int:
        """The action point that it claims."""
        return (self.start_ns + self.end_ns) // 2 if self.point_ns is None else self.point_ns


@dataclass(frozen=True)
class Truth(Interval):
    """An action that was done.

    Attributes:
        point_ns: its annotated action point, the instant at which it can be recognised; None where there is none.
    """

    label: str
    point_ns: int | None = None


class Stretch(Interval):
    """A time in which a person was seen without a longer break."""


@dataclass(frozen=True)
class Found:
    """Everything that is scored: what was found in some recordings, what was done there, and who was seen when."""

    detections: Sequence[Detection] = ()
    truths: Sequence[Truth] = ()
    seen: Sequence[Stretch] = ()

    def __add__(self, other: "Found") -> "Found":
        return Found(
            (*self.detections, *other.detections), (*self.truths, *other.truths), (*self.seen, *other.seen)
        )  # fmt: skip

    @classmethod
    def of_all(cls, parts: Iterable["Found"]) -> "Found":
        """Put the parts together."""
        listed = list(parts)
        return cls(
            [each for part in listed for each in part.detections],
            [each for part in listed for each in part.truths],
            [each for part in listed for each in part.seen],
        )

    def as_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        return {
            "detections": [asdict(detection) for detection in self.detections],
            "truths": [asdict(truth) for truth in self.truths],
            "seen": [asdict(stretch) for stretch in self.seen],
        }


def point_fractions(truths: Iterable[Truth]) -> dict[str, float]:
    """Return where in an action its action point lies, by label: the median fraction (0 to 1) of its duration."""
    fractions: dict[str, list[float]] = {}
    for truth in truths:
        if truth.point_ns is not None and truth.end_ns > truth.start_ns:
            fraction = (truth.point_ns - truth.start_ns) / (truth.end_ns - truth.start_ns)
            fractions.setdefault(truth.label, []).append(fraction)
    return {label: median_high(of_label) for label, of_label in fractions.items()}
