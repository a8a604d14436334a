"""Every service as it takes what comes over the wire, without a router: decoded, counted, handled, encoded."""

import asyncio
from collections import deque
from collections.abc import Callable, Coroutine, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

from actum import codec
from actum.bridge import Foreign
from actum.commands import JSON, MSGPACK, Command, Refusal, packed, unpacked
from actum.messages import Event, Message, Status, Training
from actum.node import SECOND_NS, Counters, Numbering, Tick
from dashboards import Colleague
from fuzzing.mutations import of_bytes, request
from model_trainer.trainer import ModelTrainer
from node_cases import CASES, CONTINUING, FINDING, FUSION, NOON_NS, Case
from people import reaches
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.frames import header, transform
from ros2_bridge.hri.types import IDS_LIST
from ros2_bridge.message_types import TF_MESSAGE, made, to_cdr
from ros2_bridge.settings import Settings as BridgeSettings
from ros2_bridge.topics import OTHERS_TRACKED, SUBSCRIBED
from teaching import ScriptedJob, mark
from web_dashboard.hub import Hub, Mailbox
from web_dashboard.node import MOST_REFUSALS, WebDashboard
from web_dashboard.orders import Orders
from web_dashboard.settings import Settings as PageSettings

FOREIGN_MARK = b"\x00\x01\x00\x00\x26\x00\x00\x00" + b'{"kind": "start", "segment_id": "abc"}' + b"\0"
"""A mark as ROS 2 puts it."""
ORDER = b'{"id": 1, "ask": {"service": "som_classifier", "command": "parameters", "fields": {"a": [1, null]}}}'
"""What a browser asks."""


@dataclass
class Target:
    """A service that is built and takes frames.

    Attributes:
        name: the service's.
        real: what it is really sent, again and again with later stamps.
        step: handles a message or a tick.
        counters: the service's own.
        commands: what it can be asked.
        foreign: takes what comes from elsewhere than our keys: another system's payloads, browsers' orders.
        sample: a real one of those.
    """

    name: str
    real: Callable[[int], Sequence[Message]]
    step: Callable[[Message | Tick], Iterable[Any]]
    counters: Counters
    commands: Mapping[str, Command[Any, Any]] = field(default_factory=dict)
    foreign: Callable[[bytes], Iterable[Message]] | None = None
    sample: bytes = b""
    numbering: Numbering = field(default_factory=Numbering)

    def put(self, frame: codec.Frame) -> None:
        """Take a frame as the runtime does."""
        try:
            message = codec.decode(frame.key, frame.payload, frame.encoding)
        except codec.DecodeError as error:
            self.counters.reject(error.kind, str(error))
            return
        self.handle(message)

    def handle(self, message: Message | Tick) -> None:
        """Handle, and encode the answers."""
        for answer in self.step(message):
            if isinstance(answer, Message):
                codec.encode(self.numbering.numbered(answer))

    def ask(self, rng: Random) -> None:
        """Ask a command with hostile fields; only a refusal may come of it."""
        command = rng.choice(list(self.commands.values()))
        try:
            reply = command.obey(unpacked(request(rng, list(command.request.model_fields)), JSON))
        except Refusal as refusal:
            self.counters.reject("refused_command", str(refusal))
            reply = {"error": str(refusal)}
        for encoding in (JSON, MSGPACK):
            packed(reply, encoding)

    def take_foreign(self, rng: Random) -> None:
        """Give it another system's payload with something wrong."""
        assert self.foreign is not None
        for answer in self.foreign(of_bytes(rng, self.sample, self.sample)):
            codec.encode(self.numbering.numbered(answer))


def _later(case: Case) -> Callable[[int], Sequence[Message]]:
    return lambda lap: case.messages(NOON_NS + lap * 10**10, f"task-{lap}")


def _of_case(case: Case) -> Target:
    node = case.build()
    commands = {command.name: command for command in getattr(node, "commands", ())}
    return Target(case.name, _later(case), node.handle, node.counters, commands)


def _everything(lap: int) -> Sequence[Message]:
    """Return what a page shows: of every topic something real."""
    now_ns = NOON_NS + lap * 10**10
    found = [message for case in CASES for message in case.messages(now_ns, f"task-{lap}")[-4:]]
    events = [answer for answer in _fused(now_ns, f"task-{lap}") if isinstance(answer, Event)]
    return [*found, *events, _status(now_ns), _training(now_ns)]


def _fused(now_ns: int, name: str) -> list[Message]:
    node = FUSION.build()
    return [answer for message in FUSION.messages(now_ns, name) for answer in node.handle(message)]


def _status(now_ns: int) -> Status:
    told: dict[str, Any] = {"service": "action_fusion", "instance": "lab-1", "uptime_s": 2.0, "state": "running"}
    counts: dict[str, Any] = {"rates": {"actum/kinect0/objects": 15.0}, "handled": {"actum/kinect0/objects": 30}}
    empty: dict[str, Any] = {"drops": {}, "rejects": {}, "latency_ms": {"p50": 0.2}, "last_error": None}
    return Status(stamp_ns=now_ns, sensor="kinect0", **told, **counts, **empty)


def _training(now_ns: int) -> Training:
    return Training(
        stamp_ns=now_ns, sensor="kinect0", recording=None, job=None, model="m", can_undo=False, revision=1
    )  # fmt: skip


@dataclass
class _Server:
    """In the place of the page's server, which nobody visits."""

    address: str = "http://127.0.0.1/"
    working: bool = True


def _dashboard(_: Path) -> Target:
    """Return the page's service with one browser that takes nothing, and one that asks."""
    hub, orders = Hub(), Orders("kinect0", deque(maxlen=MOST_REFUSALS))
    hub.join(Mailbox(lambda: None))
    orders.client = Colleague()  # type: ignore[assignment]
    node = WebDashboard(PageSettings(page_port=0), hub, orders, _Server())  # type: ignore[arg-type]

    def ordered(payload: bytes) -> Iterable[Message]:
        _finished(orders.carry_out(payload.decode("utf-8", "replace")))
        return ()

    return Target(node.name, _everything, node.handle, node.counters, foreign=ordered, sample=ORDER)


def _finished(order: Coroutine[Any, Any, Any]) -> None:
    """Carry out an order in a thread of its own: where a browser was tested before, this one's event loop is taken."""
    with ThreadPoolExecutor(1) as thread:
        answer = thread.submit(asyncio.run, order).result()
    assert "a bug occurred" not in answer, "the order met a bug"


def _bridge(_: Path) -> Target:
    node = Ros2Bridge(BridgeSettings())
    return Target(
        node.name,
        _everything,
        node.handle,
        node.counters,
        foreign=lambda p: node.receive(Foreign("mark", p)),
        sample=FOREIGN_MARK,
    )


def _bodies(_: Path) -> Target:
    node = Ros2Bridge(BridgeSettings(ros_bodies=True, ros_frame_id="camera"))
    of = header(SECOND_NS, "camera")
    ids = to_cdr(made(IDS_LIST, header=of, ids=["ab"]))
    list(node.receive(Foreign(OTHERS_TRACKED.name, ids, OTHERS_TRACKED.name)))

    def taken(payload: bytes) -> Iterable[Message]:
        """Take a payload as one of each of the topics."""
        keyed = ((topic.name, f"0{topic.name.replace('*', 'ab')}/type/hash") for topic in SUBSCRIBED[1:])
        return [message for name, key in keyed for message in node.receive(Foreign(name, payload, key))]

    transforms = [transform(of, f"{name}_ab", (0, 0, 2)) for name in ("head", "torso", "l_hip", "r_hip")]
    placed = to_cdr(made(TF_MESSAGE, transforms=transforms))
    return Target(node.name, _everything, node.handle, node.counters, foreign=taken, sample=placed)


def _trainer(folder: Path) -> Target:
    node = ModelTrainer(folder, folder / "model.npz", "kinect0", ScriptedJob, lambda: NOON_NS)
    commands = {command.name: command for command in node.commands}

    def seen(lap: int) -> Sequence[Message]:
        now_ns = NOON_NS + lap * 10**10
        frames = [f.model_copy(update={"stamp_ns": f.stamp_ns + now_ns, "seq": None}) for f in reaches(24)]
        return [mark("start", f"m{lap}"), *frames, mark("end", f"m{lap}")]

    return Target(node.name, seen, node.handle, node.counters, commands)


TARGETS: Mapping[str, Callable[[Path], Target]] = {
    **{case.name: lambda _, case=case: _of_case(case) for case in CASES},  # type: ignore[misc]
    "som_classifier, finding": lambda _: _of_case(FINDING),
    "som_classifier, continuing": lambda _: _of_case(CONTINUING),
    "web_dashboard": _dashboard,
    "model_trainer": _trainer,
    "ros2_bridge": _bridge,
    "ros2_bridge, bodies": _bodies,
}
"""How each service is built, in a folder of its own."""
