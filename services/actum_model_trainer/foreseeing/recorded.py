"""Takes of the people in recordings, and the contacts in their marked actions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from action_fusion.intake.stream_samples import objects_sample, posture_sample
from action_fusion.intent.recent_paths import arms_of
from action_fusion.settings import Settings
from actum import keys
from actum.arrays import Array
from actum.messages import Message, Objects, Posture, Truth, is_action
from actum.node import SECOND_NS, Tick, replay
from actum.recording import Recording
from actum_model_trainer.foreseeing.takes import Contact, Take
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.recorded_segments import SegmentCollector, classifier_input
from som_classifier.segments import ClosedSegment

MOVED_M = 0.02
"""An object that is so far (m) from where it rested has been touched: the noise of a tracker is less."""
REST_NS = SECOND_NS // 2
"""How long before an action (ns) the place at which an object rests is measured."""
REACH_M = 0.25
"""Largest distance (m) between a hand's joint and the middle of an object that this hand moves."""
POINTING: frozenset[str] = Settings.model_fields["pointing_labels"].default
"""Actions in which the person points at an object and does not touch it, by the fusion's default."""
FEWEST_FRAMES = 2
"""Frames of a take: with fewer it does not last."""


@dataclass(frozen=True)
class Recorded:
    """What recordings hold to foresee.

    Attributes:
        takes: of each person who is seen together with an object, of each sensor.
        without_contact: number of marked actions in which no contact was found.
    """

    takes: list[Take]
    without_contact: int

    @property
    def contacts(self) -> int:
        """The number of contacts."""
        return sum(len(take.contacts) for take in self.takes)


class Track(NamedTuple):
    """Places (n, …, 3) at rising stamps (n,), camera frame (m)."""

    stamps_ns: NDArray[np.int64]
    places_m: Array

    @classmethod
    def of(cls, placed: Sequence[tuple[int, Array]]) -> Self:
        """Return the places by stamp; one that is not newer than all before it is left out."""
        stamps_ns = np.array([stamp_ns for stamp_ns, _ in placed], np.int64)
        newest_ns = np.maximum.accumulate(stamps_ns)
        kept = np.append(True, stamps_ns[1:] > newest_ns[:-1])
        return cls(stamps_ns[kept], np.array([place_m for _, place_m in placed])[kept])

    def between(self, start_ns: int, end_ns: int) -> "Track":
        """Return the places from start to end, both included."""
        first, last = self.stamps_ns.searchsorted(start_ns), self.stamps_ns.searchsorted(end_ns, side="right")
        return Track(self.stamps_ns[first:last], self.places_m[first:last])


class ContactCollector(SegmentCollector):
    """The same, which also keeps the way of each person's arms and of each object, and which object a truth names."""

    inputs = (keys.POSTURE, keys.SEGMENT, keys.OBJECTS, keys.TRUTH)

    def __init__(self) -> None:
        super().__init__()
        self.arms: dict[int, list[tuple[int, Array]]] = {}
        self.objects: dict[int, list[tuple[int, Array]]] = {}
        self.named: dict[str, int] = {}

    def handle(self, message: Message | Tick) -> list[Message]:
        """Receive a posture, a mark, objects, a truth or a tick; put nothing."""
        match message:
            case Posture():
                body = posture_sample(message, self.counters).body
                if body is not None:
                    self.arms.setdefault(message.agent, []).append((message.stamp_ns, arms_of(body)))
            case Objects():
                for number, place_m in objects_sample(message, self.counters).positions_m.items():
                    self.objects.setdefault(number, []).append((message.stamp_ns, np.array(place_m)))
            case Truth():
                self.named[message.segment_id] = message.object_id
        return super().handle(message)

    @property
    def actions(self) -> list[ClosedSegment]:
        """The marked actions."""
        return [each for each in self.closed if each.reason is None and is_action(each.label)]


def recorded_in(recordings: Sequence[Recording], progress: Progress = silent) -> Recorded:
    """Read the takes of recordings.

    Raises:
        RecordingError: a file is damaged.
    """
    takes: list[Take] = []
    actions = 0
    for done, recording in enumerate(recordings):
        progress("reading recordings", done, len(recordings))
        for sensor in sorted({*recording.sensors(keys.SKELETON), *recording.sensors(keys.POSTURE)}):
            collected = _collected(recording, sensor)
            actions += len(collected.actions)
            takes += _takes(collected, f"{recording.path} ({sensor})")
    progress("reading recordings", len(recordings), len(recordings))
    return Recorded(takes, actions - sum(len(take.contacts) for take in takes))


def _collected(recording: Recording, sensor: str) -> ContactCollector:
    """Replay one sensor; where it has no skeletons, its recorded postures count."""
    postures = () if sensor in recording.sensors(keys.SKELETON) else (keys.POSTURE,)
    collector = ContactCollector()
    read = (keys.OBJECTS, keys.TRUTH, *postures)
    for _ in replay(collector, classifier_input(recording, sensor, read)):
        raise AssertionError("the collector puts nothing")
    return collector


def _takes(collected: ContactCollector, name: str) -> Iterator[Take]:
    """Yield a take of each person who is seen together with an object."""
    objects = {number: Track.of(placed) for number, placed in collected.objects.items()}
    for agent, postures in collected.arms.items():
        arms = Track.of(postures)
        placed = {number: _at_frames(track, arms.stamps_ns) for number, track in objects.items()}
        objects_m = {number: path_m for number, path_m in placed.items() if np.isfinite(path_m).any()}
        if len(arms.stamps_ns) >= FEWEST_FRAMES and objects_m:
            near = {number: objects[number] for number in objects_m}
            own = [each for each in collected.actions if each.agent == agent]
            found = [_contact(each, arms, near, collected.named.get(each.segment_id)) for each in own]
            contacts = sorted(contact for contact in found if contact is not None)
            pointing_ns = [(each.start_ns, each.end_ns) for each in own if each.label in POINTING]
            yield Take(f"{name}, agent {agent}", arms.stamps_ns, arms.places_m, objects_m, contacts, pointing_ns)


def _at_frames(track: Track, stamps_ns: NDArray[np.int64]) -> Array:
    """Return where an object was seen last since the frame before, (T, 3); NaN where it was not seen since."""
    path_m = np.full((len(stamps_ns), 3), np.nan)
    rows = stamps_ns.searchsorted(track.stamps_ns)
    for row, place_m in zip(rows.tolist(), track.places_m, strict=True):
        if row < len(path_m):
            path_m[row] = place_m
    return path_m


def _contact(segment: ClosedSegment, arms: Track, objects: dict[int, Track], named: int | None) -> Contact | None:
    """Return the first motion of the object that a truth names; without one, the first near a hand of any object."""
    reach_m = REACH_M if named is None else np.inf
    candidates = objects if named is None else {named: objects[named]} if named in objects else {}
    found = [_first_motion(segment, arms, number, track, reach_m) for number, track in candidates.items()]
    return min((contact for contact in found if contact is not None), default=None)


def _first_motion(segment: ClosedSegment, arms: Track, number: int, track: Track, reach_m: float) -> Contact | None:
    """Return when an object first is away from its rest while a hand is within reach (m); None where it never is."""
    rest_m = track.between(segment.start_ns - REST_NS, segment.start_ns).places_m
    stamps_ns, places_m = track.between(segment.start_ns, segment.end_ns)
    if not len(rest_m) or not len(stamps_ns):
        return None
    rows = arms.stamps_ns.searchsorted(stamps_ns, side="right") - 1
    hands_m = arms.places_m[rows.clip(0), :2]
    apart_m = np.nan_to_num(np.linalg.norm(hands_m - places_m[:, None], axis=2), nan=np.inf)
    moved = np.linalg.norm(places_m - np.median(rest_m, axis=0), axis=1) > MOVED_M
    touched = np.flatnonzero(moved & (apart_m.min(axis=1) <= reach_m))
    if not len(touched):
        return None
    row = int(touched[0])
    return Contact(int(stamps_ns[row]), int(apart_m[row].argmin()), number, segment.label or "")
