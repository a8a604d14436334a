"""One repetition of an action, what was true and what was said; and what share of many was right."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from benchmarks.rig.hard_scenes.pantomime import NO_OBJECT

from action_fusion.outcome.displacement import UNMOVED
from actum.messages import Event, Truth
from actum_model_trainer.evaluation import wilson_interval

from .unmarked import Unmarked

OURS = "joint"
NEAR_M, NEAR_SHARE = 0.02, 0.10


@dataclass(frozen=True)
class Trial:
    """What was done in truth, each measure's event, and what the joint one told where nobody marked.

    `displacement_m` (3,) is to the person's right, up and forward; `line_right` tells whether the true line from eye
    to fingertip passes its object nearer than the others, `seen_left` whether the object is seen where it ends.
    """

    truth: Truth
    displacement_m: np.ndarray | None
    line_right: bool
    seen_left: bool
    events: Mapping[str, Event]
    unmarked: Unmarked

    def object_right(self, measure: str) -> bool:
        return self.names_object(self.events[measure])

    def names_object(self, event: Event) -> bool:
        """Whether an event names the object acted on, or none in a pantomime."""
        return (NO_OBJECT if event.object is None else event.object.id) == self.truth.object_id

    @property
    def found(self) -> bool:
        """Whether the action was found where nobody marked it, under whatever name."""
        return self.unmarked.event is not None

    @property
    def named(self) -> bool:
        """Whether it was found, and named rightly."""
        return self.unmarked.event is not None and self.unmarked.event.action == self.truth.action

    @property
    def unmarked_right(self) -> bool:
        """Whether it was found, and the object is right."""
        return self.unmarked.event is not None and self.names_object(self.unmarked.event)

    @property
    def lost_by(self) -> str | None:
        """Why the object is right where the action is marked, and wrong where it is found; None where it is not so."""
        if not self.found or self.unmarked_right or not self.object_right(OURS):
            return None
        mended = [bound for bound, event in self.unmarked.with_true.items() if self.names_object(event)]
        return "action" if not self.named and not mended else " or ".join(mended) or "start and end"

    def displacement_right(self) -> bool:
        """Whether the displacement is right wherever the person was thought to face: how far level, how far up."""
        return self._is_near(lambda d: np.array([np.hypot(d[0], d[2]), d[1]]))

    def direction_right(self) -> bool:
        """Whether the displacement is right, and in the person's own directions."""
        return self._is_near(lambda d: d)

    def outcome_right(self) -> bool:
        """Whether what became of the object is what the action was to do: where it was pointed at, nothing."""
        event = self.events[OURS]
        return event.outcome == UNMOVED if self.truth.action == "point" else event.agrees is True

    def _is_near(self, seen: Callable[[np.ndarray], np.ndarray]) -> bool:
        """Whether the displacement, looked at in some way, is right to 2 cm, or to a tenth of it."""
        motion, true_m = self.events[OURS].motion, self.displacement_m
        if motion is None or true_m is None:
            return False
        missed_m = float(np.linalg.norm(seen(np.array(motion.displacement_m)) - seen(true_m)))
        return missed_m <= max(NEAR_M, NEAR_SHARE * float(np.linalg.norm(true_m)))


def share(trials: Sequence[Trial], right: Callable[[Trial], bool]) -> str:
    """Say how many are right, and Wilson's interval."""
    hits, n = sum(map(right, trials)), len(trials)
    if not n:
        return "-"
    low, high = wilson_interval(hits, n)
    return f"{hits}/{n} ({hits / n:.1%}; {low:.0%} to {high:.0%})"
