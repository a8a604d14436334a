"""`actum watch`: what happens on a sensor's keys, one line per message."""

from collections.abc import Iterator

from rich.markup import escape

from actum import keys
from actum.messages import Action, Event, Message, Objects, Segment, Skeleton, Status, TrackedObject
from actum.runtime import Client, Received


def lines(client: Client, topics: list[keys.Topic]) -> Iterator[str]:
    """Yield a line for each message on the topics, from now on."""
    leaves = {topic.leaf for topic in topics}
    only = keys.pattern(topics[0], client.sensor) if len(topics) == 1 else keys.everything(client.sensor)
    for received in client.listen(only):
        if _leaf(received.key) in leaves:
            yield line(received)


def line(received: Received) -> str:
    """Describe one received message."""
    if received.message is None:
        return f"[red]{escape(received.key)} {escape(str(received.error))}[/red]"
    return f"[dim]{escape(received.key)}[/dim] {describe(received.message)}"


def describe(message: Message) -> str:
    """Say the gist of a message in one line."""
    if isinstance(message, Event):
        return describe_event(message)
    if isinstance(message, Action):
        return _describe_action(message)
    if not message.valid:
        return f"[yellow]not valid: {escape(message.reason or '')}[/yellow]"
    return _describe_stream(message)


def _describe_action(action: Action) -> str:
    if not action.valid:
        return f"[yellow]{escape(action.segment_id)} rejected: {escape(action.reason or '')}[/yellow]"
    kind = "final" if action.final else "so far"
    answer = f"{escape(str(action.action))} {action.confidence:.2f}, {action.frames} frames"
    return f"{escape(action.segment_id)} {kind}: {answer}"


def _describe_stream(message: Message) -> str:
    match message:
        case Skeleton():
            gist = f"{len(message.agents)} agents"
        case Objects():
            gist = ", ".join(f"{o.id} {escape(o.name)}{_hidden(o)}" for o in message.objects)
        case Segment():
            gist = f"{message.kind} {escape(message.segment_id)}"
        case Status():
            return f"{escape(message.state)}, {sum(message.rates.values()):.0f} messages/s"
        case _:
            gist = message.SCHEMA
    stamp = "" if message.stamp_ns is None else f" at {message.stamp_ns / 1e9:.3f} s"
    return f"{gist}{stamp}"


def describe_event(event: Event) -> str:
    """Say an event: the sentence, or why there is none."""
    if not event.valid:
        return f"[yellow]{escape(event.segment_id)} rejected: {escape(event.reason or '')}[/yellow]"
    return f"[bold]{escape(event.sentence)}[/bold]"


def _leaf(key: str) -> str | None:
    try:
        return keys.parse(key).topic.leaf
    except keys.InvalidKeyError:
        return None


def _hidden(found: TrackedObject) -> str:
    if found.seen:
        return ""
    return " (covered, followed)" if found.followed else " (hidden)"
