"""What is found in a stream without marks, what may be asked of the search, and what is known of the search itself."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from som_classifier.frames import Frame

Finite = Annotated[float, Field(allow_inf_nan=False)]


@dataclass(frozen=True)
class SpottedSegment:
    """An action that has been found and is over.

    Attributes:
        start_ns: stamp of its first frame.
        end_ns: stamp of its last frame.
        label: the action for which it was found.
        precision: how often an action, whichever, is done in what this search finds, 0 to 1.
    """

    start_ns: int
    end_ns: int
    label: str
    precision: float = 1.0


@dataclass(frozen=True)
class Ongoing:
    """An action that seems to be going on.

    Attributes:
        start_ns: stamp of the frame at which it seems to have begun.
        label: the likeliest action.
        confidence: its probability, 0 to 1.
        completeness: how much of it has been done, 0 to 1.
    """

    start_ns: int
    label: str
    confidence: float
    completeness: float


@dataclass(frozen=True)
class Spotted:
    """What one more frame shows.

    Attributes:
        segments: the actions that are now certain, in the order in which they were done; they do not overlap.
        ongoing: the action that seems to be going on; None while there is none.
    """

    segments: tuple[SpottedSegment, ...] = ()
    ongoing: Ongoing | None = None


NOTHING = Spotted()
"""A frame that shows nothing."""


@dataclass(frozen=True)
class SpottingOptions:
    """What a user may ask of the search.

    Attributes:
        false_alarms_per_min: how many wrong segments in a minute of other doings are accepted; more of them means fewer
            missed actions. None: what the model was trained for.
        shortest_pause_s: an action that begins sooner after the one before it is not published.
        cooldown_s: by action, how long after one of it no other of it is published.
        disabled: actions that are not published.
    """

    false_alarms_per_min: float | None = None
    shortest_pause_s: float = 0.0
    cooldown_s: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    disabled: frozenset[str] = frozenset()


class SpottingMetadata(BaseModel):
    """What a model file says of the search, whichever recogniser it holds; field names are keys of the stored JSON.

    Attributes:
        thresholds: what a window's score must exceed, rising: one for each entry of `false_alarms_per_min`.
        false_alarms_per_min: cross-validated false segments in a minute of background, by threshold; empty where there
            was no background to count them in.
        threshold: the one that is used unless a rate of false alarms is asked for.
        background_s: how long people did none of the actions in training.
    """

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)

    thresholds: Annotated[list[Finite], Field(min_length=1)]
    false_alarms_per_min: list[Finite]
    threshold: Finite
    background_s: Annotated[float, Field(ge=0, allow_inf_nan=False)]

    def threshold_for(self, false_alarms_per_min: float | None) -> float:
        """Return the lowest threshold with no more false alarms a minute than these, the highest where none has so few.

        Args:
            false_alarms_per_min: as asked for; None for the threshold that was chosen in training.
        """
        if false_alarms_per_min is None or not self.false_alarms_per_min:
            return self.threshold
        rates = zip(self.thresholds, self.false_alarms_per_min, strict=True)
        return next((threshold for threshold, rate in rates if rate <= false_alarms_per_min), self.thresholds[-1])


class Spotter(ABC):
    """Searches one person's stream.

    Attributes:
        memory_ns: for how long it, or who answers what it finds, needs the activity of a frame (ns).
    """

    memory_ns: int = MAX_SEGMENT_NS + MAX_SKEW_NS

    @abstractmethod
    def step(self, frame: Frame) -> Spotted:
        """Receive the next frame, valid or not, with the activity that the model's encoder gave it if it is valid."""

    def use(self, options: SpottingOptions) -> None:  # noqa: B027 - a search may have nothing that options change
        """Go on by other options, with all that was seen so far."""
