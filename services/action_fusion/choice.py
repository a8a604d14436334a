"""The object that an action is applied to, or the reason why there is none."""

from dataclasses import dataclass

from action_fusion.object_tracks import ObjectTrack
from actum.messages import Hand, Pointing

NO_HAND = "the hand is not known"
NO_OBJECT = "no object in sight"
OUT_OF_REACH = "no object within reach"
LEFT_ALONE = "no object within reach was acted on"
OFF_THE_LINE = "no object along the arm"


@dataclass(frozen=True)
class Choice:
    """The object acted on (`track`), or `why` there is none.

    `hand` is the hand that acted, `held` the object it holds. `rivals` are objects about as likely as `track`.
    `pointing` tells how well the arm points at `track`.
    """

    track: ObjectTrack | None = None
    hand: Hand | None = None
    held: ObjectTrack | None = None
    rivals: tuple[ObjectTrack, ...] = ()
    pointing: Pointing | None = None
    why: str | None = None

    @property
    def likely(self) -> tuple[ObjectTrack, ...]:
        """The object and its rivals, the likeliest first."""
        return () if self.track is None else (self.track, *self.rivals)
