"""How this process began: as the first, or in the place of another whose answers are known."""

from collections.abc import Sequence

from actum.messages import Action
from actum.node import SECOND_NS

SETTLING_NS = SECOND_NS
"""How long after its start a process may be given marks that were put before it (ns): they come at once."""


class Beginning:
    """What is known about the time before this process.

    Attributes:
        is_resumed: whether the answers are known that were given before.
    """

    def __init__(self) -> None:
        self.is_resumed = False
        self._session: str | None = None
        self._first_tick_ns: int | None = None
        self._settled = True

    def resume(self, answers: Sequence[Action]) -> None:
        """Take the answers given before."""
        self.is_resumed, self._settled = True, False
        self._session = next((answer.session_id for answer in reversed(answers) if answer.session_id), None)

    def tick(self, now_ns: int) -> None:
        """Note that time goes on."""
        self._first_tick_ns = now_ns if self._first_tick_ns is None else self._first_tick_ns
        self._settled = self._settled or now_ns - self._first_tick_ns >= SETTLING_NS

    @property
    def is_settling(self) -> bool:
        """Whether marks may still come that were put before this process was there."""
        return not self._settled

    def is_of(self, session_id: str) -> bool:
        """Tell whether the answers given before may be of a session."""
        return self._session in (None, session_id)
