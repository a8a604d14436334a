"""Names in the service's state the joints that the source lacked lately; frames without them are no rejects."""

from collections.abc import Sequence

from actum.node import SECOND_NS, Counters
from actum.skeletons import JOINTS

LATELY_NS = 2 * SECOND_NS
"""For so long (ns) a joint is named after it was last missing: long enough to be read."""


class RecentlyMissing:
    """The joints missing from usable frames of the last two seconds, written to `Counters.state`."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._last_ns: dict[str, int] = {}

    def note(self, stamp_ns: int, missing: Sequence[str]) -> None:
        """Note the names of the joints that one person lacks in a frame."""
        self._last_ns.update(dict.fromkeys(missing, stamp_ns))

    def report(self, stamp_ns: int) -> None:
        """Bring the state up to a frame's stamp, which may be smaller than before where a source starts anew."""
        if not self._last_ns:
            return
        self._last_ns = {name: ns for name, ns in self._last_ns.items() if 0 <= stamp_ns - ns <= LATELY_NS}
        names = ", ".join(name for name in JOINTS if name in self._last_ns)
        self._counters.state = f"running without {names}" if names else "running"
