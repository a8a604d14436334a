"""The marks of the simulated scene's true actions are published once somebody listens."""

import threading
from unittest.mock import Mock

from actum import keys
from actum.messages import SIMULATOR, Segment, Truth
from actum_command.scene_marks import mark_truth

TRUTH = Truth(
    stamp_ns=5,
    sensor="kinect0",
    kind="start",
    segment_id="push-1",
    agent=1,
    hand="left",
    action="push",
    object_id=1,
    object_name="cup",
    displacement_m=None,
)


class Listened:
    """A client to whose marks somebody listens from the third look on, and that is stopped by the first mark."""

    sensor = "kinect0"

    def __init__(self) -> None:
        self.stop, self.looked, self.put_messages = threading.Event(), 0, list[Segment]()

    def listen(self, key: str) -> "Listened":
        assert key == keys.key(keys.TRUTH, self.sensor)
        return self

    def wait_for_subscriber(self, topic: keys.Topic, seconds: float) -> bool:
        assert topic is keys.SEGMENT
        self.looked += 1
        return self.looked == 3

    def receive(self) -> "Listened | None":
        return None if self.put_messages else self

    @property
    def message(self) -> Truth:
        return TRUTH

    def put(self, mark: Segment) -> None:
        self.put_messages.append(mark)
        self.stop.set()


def test_marks_wait_for_who_listens_and_say_when_an_action_starts_but_not_which() -> None:
    client = Listened()
    mark_truth(client, client.stop)  # type: ignore[arg-type]
    assert client.looked == 3
    (mark,) = client.put_messages
    assert (mark.stamp_ns, mark.kind, mark.segment_id, mark.origin) == (5, "start", "push-1", SIMULATOR)
    assert mark.label is None


def test_an_action_that_had_begun_before_is_not_marked() -> None:
    """The classifier would reject its end: it has no start."""
    names = ("end", "push-0"), ("start", "push-1"), ("end", "push-1")
    truths = [TRUTH.model_copy(update={"kind": kind, "segment_id": name}) for kind, name in names]
    stop, received, client = threading.Event(), iter(truths), Mock(sensor="kinect0")
    client.listen().receive = lambda: next((Mock(message=truth) for truth in received), stop.set())
    mark_truth(client, stop)
    assert [(call.args[0].kind, call.args[0].segment_id) for call in client.put.call_args_list] == list(names[1:])
