"""When people were seen."""

from dataclasses import replace

from actum.node import SECOND_NS
from actum_model_trainer.continuous.detections import Stretch

LONGEST_BREAK_NS = SECOND_NS
"""Time without a usable frame after which a person counts as away (ns): longer than any lost frames."""


class Presence:
    """Notes in which stretches of time people are seen.

    Args:
        file: stands for the recording in these.
    """

    def __init__(self, file: str) -> None:
        self._file = file
        self._stretches: dict[int, list[Stretch]] = {}

    def see(self, agent: int, stamp_ns: int) -> None:
        """Note that a person is seen; the stamp is later than the one before, or the clock began anew."""
        own = self._stretches.setdefault(agent, [])
        if own and 0 <= stamp_ns - own[-1].end_ns <= LONGEST_BREAK_NS:
            own[-1] = replace(own[-1], end_ns=stamp_ns)
        else:
            own.append(Stretch(self._file, agent, stamp_ns, stamp_ns))

    @property
    def stretches(self) -> list[Stretch]:
        """The stretches so far, by person, those of one person in order."""
        return [each for _, of_person in sorted(self._stretches.items()) for each in of_person]
