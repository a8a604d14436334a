"""Writes a sensor's messages as they arrive, each as a line of words or of JSON."""

from collections.abc import Iterator

from pydantic_core import to_json
from rich.markup import escape

from actum import keys
from actum.codec import schema_name
from actum.runtime import Client, Received
from actum_command.describing import describe, time_of

WATCHABLE = {topic.leaf.removesuffix("/{}"): topic for topic in keys.TOPICS}
"""All topics, by the name that a user gives them."""


def received_on(client: Client, topics: list[keys.Topic]) -> Iterator[Received]:
    """Yield the messages that arrive on the topics, from now on."""
    leaves = {topic.leaf for topic in topics}
    pattern = keys.pattern(topics[0], client.sensor) if len(topics) == 1 else keys.everything(client.sensor)
    return (received for received in client.listen(pattern) if _leaf(received.key) in leaves)


def line(received: Received) -> str:
    """Describe one received message as console markup."""
    if received.message is None:
        return f"[red]{escape(received.key)} {escape(str(received.error))}[/red]"
    return f"[dim]{time_of(received.message)} {escape(received.key)}[/dim] {describe(received.message)}"


def json_line(received: Received) -> str:
    """Write one received message as JSON: key, schema and every field; or key and error where it does not decode."""
    if received.message is None:
        fields = {"key": received.key, "error": str(received.error)}
    else:
        fields = {"key": received.key, "schema": schema_name(received.message), **received.message.model_dump()}
    return to_json(fields, bytes_mode="base64", inf_nan_mode="null").decode()


def _leaf(key: str) -> str | None:
    try:
        return keys.parse(key).topic.leaf
    except keys.InvalidKeyError:
        return None
