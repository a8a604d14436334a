"""Which of the actions found in one person's stream are told: none switched off, none too soon after another."""

from typing import Literal

from actum.node import SECOND_NS
from som_classifier.spotting.spotted import SpottingOptions

Hindrance = Literal["disabled", "pause", "cooldown"]
"""Why an action is not told: it is switched off, it began too soon after the one before, or after one of its own."""


class Admission:
    """Applies a user's options to one person's actions, in the order in which they were done, by stamps alone."""

    def __init__(self, options: SpottingOptions) -> None:
        self.options = options
        self._done_ns: int | None = None
        self._told_ns: dict[str, int] = {}

    def hindrance(self, action: str, start_ns: int) -> Hindrance | None:
        """Return why an action that begins at `start_ns` is not to be told; None where it is."""
        if action in self.options.disabled:
            return "disabled"
        if _is_within(self.options.shortest_pause_s, self._done_ns, start_ns):
            return "pause"
        if _is_within(self.options.cooldown_s.get(action, 0.0), self._told_ns.get(action), start_ns):
            return "cooldown"
        return None

    def admit(self, action: str, start_ns: int, end_ns: int) -> Hindrance | None:
        """Take the next action that has been done; return why it is not told, None where it is.

        A pause is counted from the action before, told or not, but not from one that is switched off. A cooldown is
        counted from the last one told: what is done without end is told again and again, at that interval.
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
