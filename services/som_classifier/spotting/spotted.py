"""What is found in a stream without marks, and what may be asked of the search."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Protocol, runtime_checkable

from som_classifier.frames import Frame


@dataclass(frozen=True)
class SpottedSegment:
    """An action that has been found and is over.

    Attributes:
        start_ns: stamp of its first frame.
        end_ns: stamp of its last frame.
        label: the action for which it was found.
    """

    start_ns: int
    end_ns: int
    label: str


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
        shortest_pause_s: an action that begins sooner after the one before it is not told.
        cooldown_s: by action, how long after one of it no other of it is told.
        disabled: actions that are not told.
    """

    false_alarms_per_min: float | None = None
    shortest_pause_s: float = 0.0
    cooldown_s: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    disabled: frozenset[str] = frozenset()


class Spotter(Protocol):
    """Searches one person's stream."""

    def step(self, frame: Frame) -> Spotted:
        """Take the next frame, valid or not, with the activity that the model's encoder gave it if it is valid."""
        ...


@runtime_checkable
class Adjustable(Protocol):
    """A spotter that heeds options, which may be changed while an action goes on."""

    def use(self, options: SpottingOptions) -> None:
        """Go on by other options, with all that was seen so far."""
        ...
