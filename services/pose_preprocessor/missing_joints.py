"""Names in the service's state the joints that the source lacked recently; such frames are not rejected."""

from collections.abc import Sequence

from actum.node import SECOND_NS, Counters
from actum.skeletons import JOINTS
from actum.states import State

NAMED_NS = 2 * SECOND_NS
"""How long (ns) a joint is named after it was last missing: long enough to be read."""


class RecentlyMissing:
    """The joints missing from usable frames of the last two seconds, written to `Counters.state`."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._last_ns: dict[str, int] = {}

    def note(self, stamp_ns: int, missing: Sequence[str]) -> None:
        """Note the names of the joints that one person lacks in a frame."""
        self._last_ns.update(dict.fromkeys(missing, stamp_ns))

    def report(self, stamp_ns: int) -> None:
        """Update the state at a frame's stamp, which may be smaller than before where the source has restarted."""
        if not self._last_ns:
            return
        self._last_ns = {name: ns for name, ns in self._last_ns.items() if 0 <= stamp_ns - ns <= NAMED_NS}
        names = ", ".join(name for name in JOINTS if name in self._last_ns)
        self._counters.state = f"{State.RUNNING} without {names}" if names else State.RUNNING
