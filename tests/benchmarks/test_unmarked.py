from collections.abc import Sequence

import pytest
from benchmarks.objects import unmarked
from benchmarks.objects.unmarked import Unmarked, events_of, told_unmarked

from action_fusion.settings import Settings
from actum.messages import Action, Message
from scenes import Place, acting_on, action

pytestmark = pytest.mark.thorough

ON_TABLE: Place = (0.2, 0.1, 0.5)
UP: Place = (0.2, 0.4, 0.5)
SCENE = acting_on(ON_TABLE, UP)
"""The hand is at the cup from 0.8 s on, and lifts it until 1.6 s."""
MARKED = action("lift", 0.0, 2.0, segment_id="marked")


def told(monkeypatch: pytest.MonkeyPatch, *found: Action) -> Unmarked:
    """Tell what becomes of the marked action where the classifier finds these."""

    def with_found_actions(stream: Sequence[Message]) -> list[Message]:
        return [*stream, *found]

    monkeypatch.setattr(unmarked, "_with_found_actions", with_found_actions)
    heard = sorted([*SCENE.postures(), *SCENE.sightings()], key=lambda message: message.stamp_ns or 0)
    stream: list[Message] = [*heard, MARKED]
    (answer,) = told_unmarked(stream, events_of(stream, Settings()), Settings())
    return answer


def test_an_action_is_told_by_what_overlaps_it_whatever_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    answer = told(monkeypatch, action("push", 0.1, 2.1))
    assert answer.event is not None and answer.event.action == "push"
    assert answer.alarms == 0


def test_what_has_its_name_tells_it_and_the_rest_are_alarms(monkeypatch: pytest.MonkeyPatch) -> None:
    longer, named = action("push", 0.0, 1.9, segment_id="longer"), action("lift", 1.2, 2.0, segment_id="named")
    after = action("lift", 2.2, 3.0, segment_id="after")
    answer = told(monkeypatch, longer, named, after)
    assert answer.event is not None and answer.event.segment_id == "named"
    assert answer.alarms == 2


def test_what_is_not_found_has_no_event(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch) == Unmarked(None, 0, {})


def test_the_bound_that_loses_the_object_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    answer = told(monkeypatch, action("lift", 0.0, 0.3))
    assert answer.event is not None and answer.event.object is None
    objects = {bound: event.object and event.object.id for bound, event in answer.with_true.items()}
    assert objects == {"start": None, "end": 1}


def test_where_the_object_is_the_same_nothing_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    answer = told(monkeypatch, action("lift", 0.2, 2.2))
    assert answer.event is not None and answer.event.object is not None and answer.event.object.id == 1
    assert answer.with_true == {}
