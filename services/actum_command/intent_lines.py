"""Chooses the intents that are worth a line of `actum watch`: one comes with every posture of a reach."""

from dataclasses import dataclass, replace

from actum.limits import MOST_STREAMS
from actum.messages import Intent, Message
from actum.node import SECOND_NS

LEAST = 0.3
"""A contact that is less probable has no line: hands always move a little towards something."""
LEVELS = (0.5, 0.9)
"""Probabilities at which a reach is worth another line: it is likelier than not, and it is all but certain."""
OVER_NS = SECOND_NS // 2
"""A reach of which nothing was heard for so long (ns) is over: the person was lost from view."""


@dataclass(frozen=True)
class Told:
    """What the newest lines said of a person's reach: the object, and how many of the levels it has passed."""

    stamp_ns: int
    object_id: int
    passed: int


class IntentLines:
    """Remembers what was printed of each person's reach, of `MOST_STREAMS` people at most."""

    def __init__(self) -> None:
        self._told: dict[tuple[str, int], Told] = {}

    def include(self, message: Message | None) -> bool:
        """Tell whether a message is printed: every one but intents that say nothing new.

        New is another likeliest object of probability `LEAST` or more, a probability that first passes one of `LEVELS`,
        and the end of the reach.
        """
        if not isinstance(message, Intent) or not message.valid:
            return True
        person = message.sensor, message.agent
        before = self._told.pop(person, None)
        if before is not None and not 0 <= message.stamp_ns - before.stamp_ns <= OVER_NS:
            before = None
        if not message.intended:
            return before is not None
        likeliest = message.intended[0]
        if likeliest.soon_probability < LEAST:
            if before is not None:
                self._told[person] = replace(before, stamp_ns=message.stamp_ns)
            return False
        known = before.passed if before is not None and before.object_id == likeliest.object_id else -1
        passed = max(known, sum(likeliest.soon_probability >= level for level in LEVELS))
        self._told[person] = Told(message.stamp_ns, likeliest.object_id, passed)
        if len(self._told) > MOST_STREAMS:
            del self._told[next(iter(self._told))]
        return passed > known
