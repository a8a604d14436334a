"""Which joints the source lacked lately: the service's state names them, they are no rejects."""

from collections.abc import Sequence

from actum.node import SECOND_NS, Counters
from actum.skeletons import JOINTS

LATELY_NS = 2 * SECOND_NS


class MissingLately:
    """Joints missing from usable frames within the last two seconds, told in the counters's state."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._last_ns: dict[str, int] = {}

    def note(self, stamp_ns: int, missing: Sequence[str]) -> None:
        """Note the joints that one person lacks in a frame."""
        self._last_ns.update(dict.fromkeys(missing, stamp_ns))

    def report(self, stamp_ns: int) -> None:
        """Bring the state up to a frame's stamp; stamps may start anew."""
        if not self._last_ns:
            return
        self._last_ns = {name: ns for name, ns in self._last_ns.items() if 0 <= stamp_ns - ns <= LATELY_NS}
        names = ", ".join(name for name in JOINTS if name in self._last_ns)
        self._counters.state = f"running without {names}" if names else "running"
