"""Messages that hold next to nothing, for tests of what carries them."""

from typing import Any

from actum.messages import Action, Image, Intended, Intent, Segment, Skeleton, Status


def skeleton(stamp_ns: int, seq: int | None = None, session_id: str = "then") -> Skeleton:
    return Skeleton(stamp_ns=stamp_ns, seq=seq, sensor="kinect0", agents=[], session_id=session_id)


def mark(
    kind: str,
    stamp_ns: int | None = None,
    segment_id: str = "one",
    label: str | None = None,
    origin: str | None = None,
    seq: int | None = None,
) -> Segment:
    fields = {"stamp_ns": stamp_ns, "seq": seq, "sensor": "kinect0", "kind": kind, "segment_id": segment_id}
    return Segment.model_validate({**fields, "label": label, "origin": origin})


def image(stamp_ns: int, seq: int | None = None) -> Image:
    return Image(
        stamp_ns=stamp_ns,
        seq=seq,
        sensor="kinect0",
        format="jpeg",
        width=1,
        height=1,
        data=b"jpeg",
        K=[1.0] * 9,
        distortion=[],
        skeleton_from_image=[1.0] * 16,
        session_id="then",
    )


def action(start_ns: int, end_ns: int | None, segment_id: str = "one", **fields: Any) -> Action:
    return Action(
        stamp_ns=end_ns or start_ns,
        sensor="kinect0",
        agent=1,
        segment_id=segment_id,
        start_ns=start_ns,
        end_ns=end_ns,
        action="push",
        confidence=1.0,
        activations={},
        part=None,
        frames=1,
        missed=0,
        **({"final": True} | fields),
    )


def contact(probability: float, **fields: Any) -> Intended:
    """A contact of the right hand with the cup that may come half a second later."""
    given = {"action": "lift", "object_id": 2, "object_name": "cup", "hand": "right"}
    likely = {"probability": probability, "soon_probability": probability}
    return Intended.model_validate(
        {**given, **likely, "contact_s": 0.5, "contact_std_s": 0.15, "place_m": [0.1, 0.2, 1.5], **fields}
    )


def intent(stamp_ns: int, *intended: Intended, **fields: Any) -> Intent:
    return Intent(stamp_ns=stamp_ns, sensor="kinect0", intended=list(intended), **({"agent": 1} | fields))


def status(state: str = "running") -> Status:
    return Status(
        stamp_ns=1,
        sensor="kinect0",
        service="som_classifier",
        instance="a",
        uptime_s=1.0,
        rates={},
        handled={},
        drops={},
        rejects={},
        last_error=None,
        latency_ms={},
        state=state,
    )
