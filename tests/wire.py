"""A node as the runtime runs it, bytes in and bytes out, with everything checked that holds for every node."""

import msgpack

from actum import codec, keys
from actum.messages import Action, Message, Posture
from actum.node import Node, Numbering, Tick


def packed(message: Message) -> bytes:
    """All of a message as bytes: equal bytes are equal to the last bit, NaN included."""
    return msgpack.packb(message.model_dump())


def without_seq(messages: list[Message]) -> list[bytes]:
    return [packed(message.model_copy(update={"seq": None})) for message in messages]


SMOOTHED: dict[type[Message], dict[str, object]] = {
    Posture: {"motion": None, "upright": None},
    Action: {"confidence": 0.0, "activations": {}, "familiarity": None, "maps": None, "trace": None},
}
"""What hangs on how long a stream has gone on, since motion, heading and posture are low-passed, left blank."""


def lasting(messages: list[Message]) -> list[bytes]:
    """What of messages does not hang on how long their stream has gone on: early on not even the likeliest action."""
    blank = [message.model_copy(update=SMOOTHED.get(type(message), {})) for message in messages]
    return without_seq(
        [m.model_copy(update={"action": None}) if isinstance(m, Action) and not m.final else m for m in blank]
    )


class Wire:
    """Decodes, counts, handles and encodes as a service does.

    Fails where an input is changed, where an output cannot be read back as it was put, stands on no key of the
    table, is invalid without a reason, or has a stamp that no input had.
    """

    def __init__(self, node: Node) -> None:
        self.node = node
        self._numbering = Numbering()
        self._stamps_ns = {0}

    @property
    def rejects(self) -> int:
        return sum(self.node.counters.rejects.values())

    def put(self, key: str, payload: bytes, encoding: str = "") -> list[Message]:
        try:
            message = codec.decode(key, payload, encoding)
        except codec.DecodeError as error:
            self.node.counters.reject(error.kind, str(error))
            return []
        return self.handle(message)

    def send(self, *messages: Message) -> list[Message]:
        outputs = []
        for message in messages:
            frame = codec.encode(message)
            outputs += self.put(frame.key, frame.payload, frame.encoding)
        return outputs

    def handle(self, message: Message | Tick) -> list[Message]:
        if isinstance(message, Tick):
            return [self._checked(output) for output in self.node.handle(message)]
        before = packed(message)
        self._note_stamps(message)
        outputs = [self._checked(output) for output in self.node.handle(message)]
        assert packed(message) == before, "the node changed its input"
        return outputs

    def _note_stamps(self, message: Message) -> None:
        self._stamps_ns.add(message.stamp_ns)
        if isinstance(message, Action):
            self._stamps_ns |= {message.start_ns, message.end_ns or 0}

    def _checked(self, output: Message) -> Message:
        frame = codec.encode(self._numbering.numbered(output))
        assert keys.parse(frame.key).topic in keys.TOPICS
        assert without_seq([codec.decode(frame.key, frame.payload, frame.encoding)]) == without_seq([output])
        assert output.valid or output.reason, "invalid without a reason"
        assert output.stamp_ns in self._stamps_ns, "a stamp that no input had"
        return output
