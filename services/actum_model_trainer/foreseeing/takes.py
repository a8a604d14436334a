"""Takes: the paths of a person's arms and of objects, and the contacts in them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from action_fusion.intake.stream_samples import ObjectsSample
from actum.arrays import Array, Mask
from actum.node import SECOND_NS


class Contact(NamedTuple):
    """A hand's first touch of an object in one reach: the object's first motion.

    Where the object does not move, it may be the end of a labelled approach, or of the reach of somebody who points.

    Attributes:
        stamp_ns: when it is touched.
        hand: index of the hand in `action_fusion.intent.recent_paths.SIDES`.
        number: the object's.
        action: what is done.
    """

    stamp_ns: int
    hand: int
    number: int
    action: str


@dataclass(frozen=True)
class Take:
    """T frames of a person, all places in the camera frame (m).

    Attributes:
        stamps_ns: (T,), rising.
        arms_m: (T, 6, 3), joints in the order of `action_fusion.intent.recent_paths.ARMS`, NaN where unknown.
        objects_m: by number the places of each object, (T, 3), NaN where it is not seen.
        contacts: by stamp.
        pointing_ns: start and end of each action in which the person points at something, which is no contact.
    """

    name: str
    stamps_ns: NDArray[np.int64]
    arms_m: Array
    objects_m: Mapping[int, Array]
    contacts: Sequence[Contact]
    pointing_ns: Sequence[tuple[int, int]] = ()

    def in_pointing(self, stamps_ns: NDArray[np.int64]) -> Mask:
        """Tell at which of n stamps the person points at something, (n,)."""
        pointing = np.zeros(len(stamps_ns), bool)
        for start_ns, end_ns in self.pointing_ns:
            pointing |= (stamps_ns >= start_ns) & (stamps_ns <= end_ns)
        return pointing

    @property
    def minutes(self) -> float:
        """How long it lasts."""
        return float(self.stamps_ns[-1] - self.stamps_ns[0]) / (60 * SECOND_NS)

    def sightings(self) -> Iterator[ObjectsSample]:
        """Yield the objects of every frame."""
        names = {number: f"object {number}" for number in self.objects_m}
        for row, stamp_ns in enumerate(self.stamps_ns.tolist()):
            seen = {n: path_m[row] for n, path_m in self.objects_m.items() if np.isfinite(path_m[row]).all()}
            yield ObjectsSample(stamp_ns, self.name, seen, names, frozenset(), {})
