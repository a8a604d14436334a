"""`actum watch`: what happens on a sensor's keys, one line per message."""

from collections.abc import Iterator

from rich.markup import escape

from actum import keys
from actum.messages import Action, Event, Message, Objects, Posture, Segment, Skeleton, Status
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
    if not message.valid and not isinstance(message, Event | Action):
        return f"[yellow]not valid: {escape(message.reason or '')}[/yellow]"
    match message:
        case Event():
            return describe_event(message)
        case Action() if not message.valid:
            return f"[yellow]{escape(message.segment_id)} rejected: {escape(message.reason or '')}[/yellow]"
        case Action():
            kind = "final" if message.final else "so far"
            return f"{escape(message.segment_id)} {kind}: {message.action} {message.confidence:.2f} ({message.frames} frames)"
        case Skeleton():
            return f"{len(message.agents)} agents at {message.stamp_ns / 1e9:.3f} s"
        case Posture():
            return f"agent {message.agent} at {message.stamp_ns / 1e9:.3f} s"
        case Objects():
            return (
                ", ".join(f"{o.id} {escape(o.name)}{'' if o.seen else ' (hidden)'}" for o in message.objects) or "none"
            )
        case Segment():
            return f"{message.kind} {escape(message.segment_id)}"
        case Status():
            return f"{message.state}, {sum(message.rates.values()):.0f} messages/s"
        case _:
            return f"at {message.stamp_ns} ns" if message.stamp_ns is not None else ""


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
