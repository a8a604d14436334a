"""The search for unmarked actions in one person's stream: its spotter, what is published, and the ids of segments."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from actum.messages import Posture
from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.spotting.spotted import NOTHING, Spotted, Spotter, SpottingOptions

SESSION_DIGITS = 6
"""Hexadecimal digits that stand for a session in a segment's id: clocks may begin alike in two sessions."""


Hindrance = Literal["disabled", "pause", "cooldown"]
"""Why an action is not published: it is switched off, or began too soon after the one before or one of its label."""


class Admission:
    """Applies a user's options to one person's actions, in the order in which they were done, by stamps alone."""

    def __init__(self, options: SpottingOptions) -> None:
        self.options = options
        self._done_ns: int | None = None
        self._told_ns: dict[str, int] = {}

    def hindrance(self, action: str, start_ns: int) -> Hindrance | None:
        """Return why an action that begins at `start_ns` is not to be published; None where it is."""
        if action in self.options.disabled:
            return "disabled"
        if _is_within(self.options.shortest_pause_s, self._done_ns, start_ns):
            return "pause"
        if _is_within(self.options.cooldown_s.get(action, 0.0), self._told_ns.get(action), start_ns):
            return "cooldown"
        return None

    def admit(self, action: str, start_ns: int, end_ns: int) -> Hindrance | None:
        """Take the next action that has been done; return why it is not published, None where it is.

        A pause is counted from the action before, published or not, but not from one that is switched off. A cooldown
        is counted from the last one published: what is done without end is published again at that interval.
        """
        hindrance = self.hindrance(action, start_ns)
        if hindrance != "disabled":
            self._done_ns = end_ns
        if hindrance is None:
            self._told_ns[action] = end_ns
        return hindrance


def _is_within(interval_s: float, since_ns: int | None, start_ns: int) -> bool:
    """Tell whether a start follows an earlier end by less than an interval."""
    return since_ns is not None and start_ns - since_ns < interval_s * SECOND_NS


@dataclass(frozen=True)
class SearchPlan:
    """How all streams are searched.

    Attributes:
        spotter: makes the spotter of one stream; None where there is no search.
        options: what a user asks of it.
    """

    spotter: Callable[[], Spotter | None] = lambda: None
    options: SpottingOptions = field(default_factory=SpottingOptions)


NO_SEARCH = SearchPlan()
"""Only marked segments are wanted, or there is no model."""


class Search:
    """Searches the stream that begins with a posture.

    The segments' ids name the agent, the session, the stamp of that posture (µs) and a running number: they are the
    same whenever the same stream is searched, and differ where a service, a sensor or a person begins anew.

    Attributes:
        admission: decides which of the actions found are published.
        is_ongoing: whether an action seemed to be going on at the last frame.
    """

    def __init__(self, first: Posture, plan: SearchPlan) -> None:
        session = hashlib.sha256(first.session_id.encode()).hexdigest()[:SESSION_DIGITS]
        self._stream_id = f"auto-{first.agent}-{session}-{first.stamp_ns // 1000}"
        self._told = 0
        self.is_ongoing = False
        self._begin(plan)

    @property
    def next_id(self) -> str:
        """The id that the next segment gets."""
        return f"{self._stream_id}-{self._told + 1}"

    @property
    def memory_ns(self) -> int:
        """For how long it needs the activity of a frame (ns)."""
        return 0 if self._spotter is None else self._spotter.memory_ns

    def count_told(self) -> None:
        """Use up `next_id`, for a segment that is published."""
        self._told += 1

    def use(self, plan: SearchPlan) -> None:
        """Go on with another model's spotter, which knows nothing of the frames before; cooldowns go on."""
        self._plan, self._spotter = plan, plan.spotter()
        self.admission.options = plan.options

    def adjust(self, plan: SearchPlan) -> None:
        """Go on by another plan for the same model: what was seen of an action that goes on still counts."""
        if self._spotter is None or plan is NO_SEARCH:
            self.use(plan)
            return
        self._plan, self.admission.options = plan, plan.options
        self._spotter.use(plan.options)

    def restart(self) -> None:
        """Begin anew, since the stream's clock has: nothing before counts but the numbers that are used up."""
        self._begin(self._plan)

    def step(self, frame: Frame) -> Spotted:
        """Search the next frame of the stream."""
        spotted = NOTHING if self._spotter is None else self._spotter.step(frame)
        self.is_ongoing = spotted.ongoing is not None
        return spotted

    def _begin(self, plan: SearchPlan) -> None:
        self._plan, self._spotter = plan, plan.spotter()
        self.admission = Admission(plan.options)
