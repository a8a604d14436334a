"""What another person moves is not this person's, and nobody's answer depends on whose postures come first."""

from collections.abc import Sequence
from itertools import chain

import numpy as np
import pytest

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Event, Message, Posture
from actum.node import SECOND_NS, Tick
from fused import events_of
from scenes import REST_RIGHT, Place, Scene, acting_on, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)
PUSHED: Place = (0.1, 0.0, 0.65)
BESIDE: Place = (0.1, 0.08, 0.72)

PUSHING = acting_on(CUP, PUSHED)
WATCHING = Scene(right_hand=still(BESIDE), objects=PUSHING.objects)


def postures(scene: Scene, agent: int, agents: list[int]) -> list[Posture]:
    return [posture.model_copy(update={"agent": agent, "agents": agents}) for posture in scene.postures()]


def events_from(*streams: Sequence[Message]) -> list[Event]:
    return events_of(ActionFusion(Settings()), *chain(*streams))


@pytest.mark.parametrize("others_first", [True, False])
def test_what_another_moves_is_not_acted_on(others_first) -> None:
    watching, pushing = postures(WATCHING, 1, [1, 2]), postures(PUSHING, 2, [1, 2])
    streams = [pushing, watching] if others_first else [watching, pushing]
    (event,) = events_from([action("act")], WATCHING.sightings(), *streams)
    assert (event.object, event.why) == (None, 'no object within reach was acted on; another moved object 1 "cup"')


def test_alone_beside_a_thing_that_moves_it_is_acted_on() -> None:
    (event,) = events_from(postures(WATCHING, 1, [1]), WATCHING.sightings(), [action("act")])
    assert event.object is not None and event.object.name == "cup"


def test_who_moves_it_acts_on_it_though_another_is_near() -> None:
    streams = [postures(WATCHING, 1, [1, 2]), postures(PUSHING, 2, [1, 2]), PUSHING.sightings()]
    (event,) = events_from(*streams, [action("push", agent=2)])
    assert event.object is not None
    assert (event.object.name, event.outcome) == ("cup", "pushed")


def test_each_acts_on_what_one_gave_to_the_other() -> None:
    met, end = (0.1, 0.2, 0.5), (0.4, 0.2, 0.9)
    giving = moving((0.2, REST_RIGHT), (0.5, (0.1, 0.08, 0.45)), (1.0, (0.1, 0.28, 0.5)), (1.5, (0.1, 0.28, 0.5)))
    taking = moving((0.6, (0.5, 0.3, 1.2)), (1.2, (0.15, 0.22, 0.55)), (1.5, (0.15, 0.22, 0.55)), (2.2, end))
    beside = (0.05, 0.02, 0.05)
    cup = moving((0.5, CUP), (1.0, met), (1.5, met), (2.2, tuple(np.subtract(end, beside).tolist())))
    back = moving((1.5, (0.1, 0.28, 0.5)), (2.0, REST_RIGHT))
    giver = Scene(right_hand=lambda t: giving(t) if t < 1.5 else back(t), objects={1: cup})
    for agent in (1, 2):
        streams = [postures(giver, 1, [1, 2]), postures(Scene(right_hand=taking), 2, [1, 2]), giver.sightings()]
        (event,) = events_from(*streams, [action("give", end_s=2.3, agent=agent)])
        assert event.object is not None and event.object.name == "cup"


def test_one_who_left_is_not_waited_for() -> None:
    watching, pushing = postures(WATCHING, 1, [1]), postures(PUSHING, 2, [1, 2])
    there = pushing[: len(pushing) // 3]
    last_ns = there[-1].stamp_ns
    watching = [p.model_copy(update={"agents": [1, 2] if p.stamp_ns <= last_ns else [1]}) for p in watching]
    assert len(events_from(there, watching, WATCHING.sightings(), [action("act")])) == 1


def test_one_whose_postures_never_come_is_waited_for_no_longer_than_for_a_stream() -> None:
    node = ActionFusion(Settings())
    messages: list[Message] = [*postures(WATCHING, 1, [1, 2]), *WATCHING.sightings(), action("act")]
    assert [event for message in messages for event in node.handle(message)] == []
    assert len([event for s in range(4) for event in node.handle(Tick(s * SECOND_NS))]) == 1
