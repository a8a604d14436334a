"""What fusion answers when it is fed a scene."""

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Action, Event, Intent, Message
from scenes import Scene


def events_of(node: ActionFusion, *messages: Message) -> list[Event]:
    """Feed a node one message after the other; all that it puts are events and intents."""
    put = [each for message in messages for each in node.handle(message)]
    assert {type(each) for each in put} <= {Event, Intent}
    return [each for each in put if isinstance(each, Event)]


def intents_of(node: ActionFusion, *messages: Message) -> list[Intent]:
    """Feed a node one message after the other; return the intents that it puts."""
    return [each for message in messages for each in node.handle(message) if isinstance(each, Intent)]


def event_of(*messages: Message, **chosen: object) -> Event:
    """Feed a new node messages that it rejects none of; it answers once."""
    node = ActionFusion(Settings(**chosen))  # type: ignore[arg-type]
    (event,) = events_of(node, *messages)
    assert not node.counters.rejects
    return event


def event_in(scene: Scene, act: Action, **chosen: object) -> Event:
    """Feed a new node the whole scene, then the action."""
    return event_of(*scene.postures(), *scene.sightings(), act, **chosen)
