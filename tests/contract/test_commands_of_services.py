"""Whatever a service is asked, it answers or refuses in words, in either encoding, and goes on as before."""

import json
import math
import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol, Self

import msgpack
import pytest
import zenoh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings as FusionSettings
from actum import keys
from actum.codec import decode, encode
from actum.commands import JSON, MSGPACK, Command, NoFields
from actum.messages import Message
from actum.node import TICK_NS, Counters, Tick
from actum.runtime.commanding import Commander
from actum.runtime.reporting import Meter
from actum.runtime.turns import Turns
from actum.settings import ServiceSettings
from model_trainer.trainer import ModelTrainer
from node_cases import CASES
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from recognisers import tiny_model
from scene_simulator.driven_simulator import DrivenSimulator
from scene_simulator.settings import Settings as SceneSettings
from som_classifier.node import SomClassifier
from som_classifier.settings import Settings as ClassifierSettings
from spotters import beating
from teaching import Teacher

PREPROCESSOR, CLASSIFIER, _, FUSION = CASES
SERVICES = Path(__file__).parents[2] / "services"
OUTSIDE = "outside"
FRAMES = 50


class Asked(Protocol):
    counters: Counters
    name: str

    @property
    def commands(self) -> Iterable[Command[Any, Any]]: ...


def configured_classifier(_folder: Path) -> SomClassifier:
    node = SomClassifier.configured(ClassifierSettings())
    node._use(beating(tiny_model()))
    return node


def trainer_with_a_set(folder: Path) -> ModelTrainer:
    teacher = Teacher(folder)
    teacher.ask("create_set", set="kitchen")
    return teacher.trainer


BUILDERS: Mapping[str, tuple[Callable[[Path], Asked], Callable[[], list[Message]]]] = {
    "pose_preprocessor": (lambda _: PosePreprocessor(PoseSettings()), PREPROCESSOR.messages),
    "som_classifier": (configured_classifier, CLASSIFIER.messages),
    "action_fusion": (lambda _: ActionFusion(FusionSettings()), FUSION.messages),
    "sensor_gateway": (lambda _: DrivenSimulator(SceneSettings(driven=True, image_hz=0), 0), list),
    "model_trainer": (trainer_with_a_set, PREPROCESSOR.messages),
}


@dataclass
class Question:
    """In the place of Zenoh's query."""

    key_expr: zenoh.KeyExpr
    encoding: str
    payload: zenoh.ZBytes
    replies: list[tuple[bool, bytes, str]] = field(default_factory=list)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def reply(self, _key: str, payload: bytes, encoding: str) -> None:
        self.replies.append((True, payload, encoding))

    def reply_err(self, payload: bytes, encoding: str) -> None:
        self.replies.append((False, payload, encoding))


class Desk:
    """A service that is asked, and held against what must be true of it afterwards."""

    def __init__(self, name: str, folder: Path, build: Callable[[Path], Asked] | None = None) -> None:
        usual, self._messages = BUILDERS[name]
        (folder / OUTSIDE).mkdir()
        (folder / OUTSIDE / "kept.txt").write_text("kept")
        self._outside = folder / OUTSIDE
        self.node = (build or usual)(folder / "own")
        self.commands = {command.name: command for command in self.node.commands}
        self._failures: list[str] = []
        self._meter = Meter(name, self.node.counters, ServiceSettings())
        self._commander = Commander(
            tuple(self.node.commands), ServiceSettings(), name, self.node.counters, Turns(),
            lambda where, error: self._failures.append(f"{where}: {error!r}"),
        )  # fmt: skip
        self._base = keys.commands_key(ServiceSettings().sensor, name)
        self._tick_ns = 0
        self._frames = self.node.frames() if isinstance(self.node, DrivenSimulator) else iter(())

    def ask(self, command: str, payload: bytes, encoding: str) -> tuple[bool, dict[str, Any]]:
        question = Question(zenoh.KeyExpr(f"{self._base}/{command}"), encoding, zenoh.ZBytes(payload))
        self._commander._answer(question)  # type: ignore[arg-type]
        assert not self._failures, f"{command} {payload[:300]!r} met a bug: {self._failures}"
        [(good, reply, _)] = question.replies
        fields = json.loads(reply, parse_constant=_never) if encoding == JSON else msgpack.unpackb(reply)
        assert good or fields["error"]
        return good, fields

    def check(self) -> None:
        """It handles ticks and messages, its status can be sent, and its settings are finite."""
        if hasattr(self.node, "handle"):
            for message in self._messages():
                self._put(message)
        else:
            for messages in islice(self._frames, FRAMES):
                assert all(map(encode, messages))
        frame = encode(self._meter.status())
        decode(frame.key, frame.payload, frame.encoding)
        encode(self._meter.info())
        if "parameters" in self.commands:
            for encoding in (JSON, MSGPACK):
                good, listed = self.ask("parameters", b"", encoding)
                assert good and all(_is_finite(each["value"]) for each in listed["parameters"])
        assert (self._outside / "kept.txt").read_text() == "kept"

    def _put(self, message: Message) -> None:
        for each in (message, Tick(self._tick_ns)):
            for answer in self.node.handle(each):  # type: ignore[attr-defined]
                encode(answer)
        self._tick_ns += TICK_NS


def _never(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")


def _is_finite(value: Any) -> bool:
    if isinstance(value, dict):
        return all(map(_is_finite, value.values()))
    return (
        all(map(_is_finite, value)) if isinstance(value, list) else not isinstance(value, float) or math.isfinite(value)
    )


@contextmanager
def desk_of(name: str) -> Any:
    with TemporaryDirectory() as folder:
        desk = Desk(name, Path(folder))
        yield desk
        if "discard" in desk.commands:
            desk.ask("discard", b"", JSON)  # a take that is still recorded would leave its file open


HOSTILE = (
    math.inf, -math.inf, math.nan, 1e308, 5e-324, -1.0, -1, 0, 2**53, 2**63, 2**64, 2**70, "", "\ud800", "a\udfffb",
    "\x00", "x" * 2000, "é" * 300, "/", "..", f"../{OUTSIDE}", f"../../{OUTSIDE}", "*", "**", "$", "$*", "a/b", "self",
    "kitchen", "wave", "inf", "nan", "1e999", None, True, b"\xff\xfe", b"", [], {}, [[]], [math.inf], {"a": math.nan},
    {"wave": math.inf}, {"\ud800": 1.0}, ["\ud800"], msgpack.ExtType(5, b"x"), msgpack.Timestamp(1, 2),
)  # fmt: skip
hostile = st.sampled_from(HOSTILE)
free = st.recursive(
    hostile | st.integers(-(2**66), 2**66) | st.floats() | st.text(st.characters(), max_size=6) | st.booleans(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=8,
)


def of_schema(schema: Mapping[str, Any], defined: Mapping[str, Any], names: tuple[str, ...]) -> st.SearchStrategy[Any]:
    """Values as a command's own schema wants them, with anything else at any place."""
    if "$ref" in schema:
        return of_schema(defined[schema["$ref"].rpartition("/")[2]], defined, names)
    if "anyOf" in schema:
        return st.one_of([of_schema(each, defined, names) for each in schema["anyOf"]])
    return hostile | _wanted(schema, defined, names)


def _wanted(schema: Mapping[str, Any], defined: Mapping[str, Any], names: tuple[str, ...]) -> st.SearchStrategy[Any]:  # noqa: PLR0911
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    match schema.get("type"):
        case "object" if "properties" in schema:
            fields = {name: of_schema(each, defined, names) for name, each in schema["properties"].items()}
            required = {name: fields.pop(name) for name in schema.get("required", ())}
            return st.fixed_dictionaries(required, optional=fields)
        case "object":
            return st.dictionaries(st.sampled_from(names) | st.text(max_size=4), hostile | free, min_size=1, max_size=2)
        case "array":
            return st.lists(of_schema(schema.get("items", {}), defined, names), max_size=3)
        case "integer":
            return st.integers(schema.get("minimum", -5), 100)
        case "number":
            return st.floats(0, 100)
        case "string":
            return st.sampled_from(("kitchen", "wave", "lift", "point", "anna", "20200101-000000"))
        case "boolean":
            return st.booleans()
    return free


def payload_of(fields: Any, encoding: str) -> bytes:
    """Fields as somebody writes them who is held back by nothing; what an encoding has no form for is a text in it."""
    if encoding == JSON:
        return json.dumps(fields, default=str).encode()
    return bytes(msgpack.packb(_packable(fields), unicode_errors="surrogatepass"))


def _packable(value: Any) -> Any:
    if isinstance(value, int) and not -(2**63) <= value < 2**64:
        return msgpack.ExtType(1, str(value).encode())
    if isinstance(value, dict):
        return {name: _packable(each) for name, each in value.items()}
    return [_packable(each) for each in value] if isinstance(value, list) else value


@cache
def commands_of(name: str) -> dict[str, tuple[dict[str, Any], tuple[str, ...]]]:
    """Each command's schema, and the names that its service's settings have."""
    with desk_of(name) as desk:
        listed = desk.ask("parameters", b"", JSON)[1]["parameters"] if "parameters" in desk.commands else []
        names = tuple(each["name"] for each in listed) or ("kitchen",)
        return {each.name: (each.request.model_json_schema(), names) for each in desk.commands.values()}


every_command = pytest.mark.parametrize(
    ("service", "command"), [(service, command) for service in BUILDERS for command in commands_of(service)]
)


@every_command
@settings(max_examples=10, suppress_health_check=list(HealthCheck), deadline=None)
@given(data=st.data())
def test_whatever_is_asked_is_answered_or_refused_and_survived(service: str, command: str, data: st.DataObject) -> None:
    schema, names = commands_of(service)[command]
    wanted = _wanted(schema, schema.get("$defs", {}), names)
    with desk_of(service) as desk:
        for fields in data.draw(st.lists(wanted | wanted | wanted | free, min_size=1, max_size=6)):
            for encoding in (JSON, MSGPACK):
                desk.ask(command, payload_of(fields, encoding), encoding)
        desk.check()


SETTING = [
    (service, name)
    for service in BUILDERS
    for name in commands_of(service).get("set_parameters", ({}, ()))[1]
]  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize(("service", "setting"), SETTING)
def test_no_value_of_a_setting_ends_or_mutes_a_service(service: str, setting: str) -> None:
    with desk_of(service) as desk:
        for value in HOSTILE:
            for each in (value, [value], {"wave": value}, {"wave": [value]}):
                for encoding in (JSON, MSGPACK):
                    accepted, _ = desk.ask(
                        "set_parameters", payload_of({"values": {setting: each}}, encoding), encoding
                    )
                    if accepted:
                        desk.check()
        desk.check()


PAYLOADS = {
    "NaN": (b'{"values": {"x": NaN}}', JSON),
    "Infinity": (b'{"values": {"x": -Infinity}}', JSON),
    "1e999": (b'{"values": {"x": 1e999}}', JSON),
    "an integer of 65 bits": (b'{"values": {"x": 18446744073709551616}}', JSON),
    "an integer of 5000 digits": (b'{"values": {"x": ' + b"9" * 5000 + b"}}", JSON),
    "half a surrogate pair": (b'{"values": {"x": "\\ud800"}}', JSON),
    "a name that is half a pair": (b'{"\\udfff": 1}', JSON),
    "a surrogate in UTF-8": (b'{"values": {"x": "\xed\xa0\x80"}}', JSON),
    "a name twice": (b'{"values": {"x": 1}, "values": {"x": 2}}', JSON),
    "nested deeply": (b'{"values":' + b"[" * 3000 + b"]" * 3000 + b"}", JSON),
    "nested without end": (b'{"values":' + b"[" * 90_000, JSON),
    "infinity in msgpack": (msgpack.packb({"values": {"x": math.inf}}), MSGPACK),
    "NaN in msgpack": (msgpack.packb({"values": [math.nan]}), MSGPACK),
    "an extension type": (msgpack.packb({"values": msgpack.ExtType(5, b"")}), MSGPACK),
    "a time": (msgpack.packb({"values": msgpack.Timestamp(1, 2)}), MSGPACK),
    "a text that is no UTF-8": (b"\x81\xa6values\xa2\xff\xfe", MSGPACK),
    "a name that is no text": (b"\x81\xa6values\x81\x01\x02", MSGPACK),
    "a name twice in msgpack": (b"\x82\xa1x\x01\xa1x\x02", MSGPACK),
    "nested deeply in msgpack": (b"\x81\xa6values" + b"\x91" * 900 + b"\x01", MSGPACK),
    "nested without end in msgpack": (b"\x81\xa6values" + b"\x91" * 30_000, MSGPACK),
}


@pytest.mark.thorough
@pytest.mark.parametrize(("payload", "encoding"), PAYLOADS.values(), ids=PAYLOADS.keys())
@pytest.mark.parametrize("service", BUILDERS)
def test_what_one_of_the_encodings_cannot_hold_is_refused_before_any_command_sees_it(
    service: str, payload: bytes, encoding: str
) -> None:
    with desk_of(service) as desk:
        for command in desk.commands:
            good, reply = desk.ask(command, payload, encoding)
            assert not good and reply["error"].startswith(("the request", "a text in the request")), command
        desk.check()


def test_every_command_of_every_service_is_asked() -> None:
    written = {name for file in SERVICES.rglob("*.py") for name in re.findall(r'\bCommand\("(\w+)"', file.read_text())}
    asked = {command for service in BUILDERS for command in commands_of(service)}
    assert written and written <= asked, written - asked


def test_an_answer_that_an_encoding_cannot_hold_is_refused_and_ends_nothing() -> None:
    class Scores(BaseModel):
        scores: list[float]

    class Scorer:
        counters = Counters()
        name = "model_trainer"
        commands = (Command("scores", NoFields, Scores, lambda _: Scores(scores=[math.nan])),)

    with TemporaryDirectory() as folder:
        desk = Desk("model_trainer", Path(folder), lambda _: Scorer())
        good, reply = desk.ask("scores", b"", JSON)
    assert not good and reply["error"].startswith("the command was carried out, but its reply cannot be sent")
