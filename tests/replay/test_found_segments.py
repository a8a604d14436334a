"""An action that nobody marked becomes the event that it becomes where somebody marks it, from end to end."""

from collections.abc import Sequence

import pytest

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import AUTO, Action, Event, Message, Segment
from actum.node import SECOND_NS
from chain import by_key, delayed, merged, replayed
from recognisers import tiny_model
from scenes import acting_on, at
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.spotting.spotted import SpottedSegment
from spotters import finding
from wire import without_seq

SCENE = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.25, 0.0, 0.5)})
ACTED = SpottedSegment(at(0.0), at(1.5), "push")
LATE = [(0.0, 0.0), (2.0, 0.0), (0.0, 2.0), (0.3, 1.1)]


def put(model: Model, marks: Sequence[Segment] = (), posture_late_s: float = 0.0, object_late_s: float = 0.0) -> dict:
    """What classifier and fusion put, by the message's type."""
    late_ns = [round(late_s * SECOND_NS) for late_s in (posture_late_s, object_late_s)]
    (postures,), (objects,) = by_key(SCENE.postures()).values(), by_key(SCENE.sightings()).values()
    streams = [delayed(postures, [late_ns[0]]), delayed(objects, [late_ns[1]]), [(m.stamp_ns or 0, m) for m in marks]]
    from_classifier = replayed(SomClassifier(model), merged(streams))
    finals = [(at_ns, m) for at_ns, m in from_classifier if isinstance(m, Action)]
    events = replayed(ActionFusion(Settings()), merged([*streams, finals]))
    messages: list[Message] = [m for _, m in [*from_classifier, *events]]
    return {kind: [m for m in messages if isinstance(m, kind)] for kind in (Segment, Action, Event)}


def named(messages: Sequence[Message], name: str) -> list[bytes]:
    return without_seq([m.model_copy(update={"segment_id": name}) for m in messages])


@pytest.mark.parametrize("late_s", LATE)
def test_the_event_is_that_of_a_marked_segment(late_s: tuple[float, float]) -> None:
    """Whichever stream is late: by then the segment lies in the past, as it does anyway."""
    found = put(finding(tiny_model(), ACTED), (), *late_s)
    bounds = (("start", ACTED.start_ns), ("end", ACTED.end_ns))
    marks = [Segment(stamp_ns=ns, sensor="kinect0", kind=kind, segment_id="hand", agent=1) for kind, ns in bounds]  # type: ignore[arg-type]
    marked = put(finding(tiny_model()), marks, *late_s)
    [event] = found[Event]
    assert event.valid and event.object is not None and event.object.name == "cup"
    assert [m.origin for m in found[Segment]] == [AUTO, AUTO] and not marked[Segment]
    assert named(found[Event], "") == named(marked[Event], "")


def test_a_minute_of_found_segments_gives_an_event_for_each_answer_and_no_invalid_one() -> None:
    many = [SpottedSegment(at(0.1 * n), at(0.1 * n + 0.09), "push") for n in range(30)]
    found = put(finding(tiny_model(), *many))
    finals = [m for m in found[Action] if m.final]
    assert [e.segment_id for e in found[Event]] == [m.segment_id for m in finals]
    assert all(e.valid for e in found[Event])
