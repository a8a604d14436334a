"""Events that say little, for tests of what shows them."""

from actum.messages import ActedObject, Event


def event(segment_id: str, sentence: str, reason: str | None = None, action: str = "push", name: str = "cup") -> Event:
    return Event(
        stamp_ns=2,
        sensor="kinect0",
        valid=reason is None,
        reason=reason,
        agent=1,
        segment_id=segment_id,
        start_ns=1,
        end_ns=2,
        action=action,
        confidence=1.0,
        activations={},
        object=ActedObject(id=1, name=name, distance_m=0.1),
        held=None,
        hand=None,
        objects_present=[1],
        distances_m={},
        motion=None,
        result=None,
        sentence=sentence,
        frames=1,
        missed=0,
    )
