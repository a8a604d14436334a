"""What fusion answers when it is fed a scene."""

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Action, Event, Message
from scenes import Scene


def events_of(node: ActionFusion, *messages: Message) -> list[Event]:
    """Feed a node one message after the other; all that it answers are events."""
    answered = [answer for message in messages for answer in node.handle(message)]
    events = [answer for answer in answered if isinstance(answer, Event)]
    assert events == answered
    return events


def event_of(*messages: Message, **chosen: object) -> Event:
    """Feed a new node messages that it rejects none of; it answers once."""
    node = ActionFusion(Settings(**chosen))  # type: ignore[arg-type]
    (event,) = events_of(node, *messages)
    assert not node.counters.rejects
    return event


def event_in(scene: Scene, act: Action, **chosen: object) -> Event:
    """Feed a new node the whole scene, then the action."""
    return event_of(*scene.postures(), *scene.sightings(), act, **chosen)
