"""The checks of each service: that it is there, alive and of one version; they say what to do where it is not."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from actum import __version__, keys
from actum.codec import schema_name
from actum.messages import MESSAGES, Info, Status
from actum.states import State
from actum_command.doctor.heard import STATUS_S, Heard
from scene_simulator.endless_simulator import DESCRIPTION

MARKS_IGNORED = "marks_ignored"
"""What a classifier counts whose settings leave marks out."""

LIMIT = "too_many_"
"""The prefix of the kinds of rejects that count what a service had no room for."""

PROGRAMS = {"sensor_gateway": "'python -m sensor_gateway' (for the simulated scene 'python -m scene_simulator')"}
"""The programs to start for a service, where there is more than one of its name."""


@dataclass(frozen=True)
class Finding:
    """The result of the check of one service: its own report, in words, its problems, and what is no problem."""

    service: str
    instances: int
    version: str
    state: str
    rates: str
    rejects: str
    drops: str
    latency: str
    problems: tuple[str, ...]
    source: str = ""
    counts: str = ""
    remarks: tuple[str, ...] = ()


def finding(name: str, heard: Heard) -> Finding:
    """Check one service by what was heard of it."""
    infos = [info for info in heard.infos if info.service == name]
    said = heard.statuses.get(name, [])
    status = said[-1] if said else None
    instances = heard.tokens.get(name) or [status.instance for status in said[-1:]]
    return Finding(
        service=name,
        instances=max(len(instances), len(infos) if instances else 0),
        source=", ".join(dict.fromkeys(info.source for info in infos if info.source)),
        version=", ".join(dict.fromkeys(info.version for info in infos)),
        state=status.state if status else "",
        rates=_rates(status) if status else "",
        rejects=", ".join(f"{kind} {n}" for kind, n in status.rejects.items()) if status else "",
        drops=", ".join(f"{_short(key, status)} {n}" for key, n in status.drops.items()) if status else "",
        latency=_latency(status.latency_ms) if status else "",
        problems=tuple(_problems(name, instances, infos, status)),
        counts=", ".join(f"{kind} {n}" for kind, n in status.counts.items()) if status else "",
        remarks=tuple(_remarks(name, status)) if status else (),
    )


def _rates(status: Status) -> str:
    """Return what comes in, or is put, as text: by topic, of all people and services together, without silent ones."""
    by_topic: defaultdict[str, float] = defaultdict(float)
    for key, rate in status.rates.items():
        by_topic[_topic(key, status)] += rate
    return ", ".join(f"{topic} {rate:.3g}" for topic, rate in by_topic.items() if rate)


def _topic(key: str, status: Status) -> str:
    """Return a key's topic without agent or service, `posture` for `actum/kinect0/posture/1`."""
    try:
        return keys.parse(key).topic.leaf.removesuffix("/{}")
    except keys.InvalidKeyError:
        return _short(key, status)


def _short(key: str, status: Status) -> str:
    return key.removeprefix(f"{keys.BASE}/{status.sensor}/")


def _latency(latency_ms: Mapping[str, float]) -> str:
    """Return both percentiles as text, a dash for one that a foreign service does not report."""
    if not latency_ms:
        return ""
    return " / ".join(f"{latency_ms[name]:.2f}" if name in latency_ms else "-" for name in ("p50", "p99"))


def _problems(name: str, instances: list[str], infos: list[Info], status: Status | None) -> Iterator[str]:
    if not instances:
        program = PROGRAMS.get(name, f"'python -m {name}'")
        yield f"{name} is not running: start it with {program}, or start all services with 'actum up'"
        return
    if len(instances) > 1 or len(infos) > 1:
        running = _who(infos, instances)
        yield (
            f"more than one instance of {name} runs ({running}), so every result is published more than once: stop all "
            "instances but one"
        )
    if status is None:
        yield f"{name} runs but published no status message for {STATUS_S:g} s: if this persists, restart {name}"
    else:
        yield from _troubles(name, status, next((f" ({info.source})" for info in infos if info.source), ""))
    if not infos:
        yield f"{name} does not answer queries on its info key: if this persists, restart {name}"
    yield from dict.fromkeys(line for info in infos for line in _versions(info))


def _who(infos: list[Info], instances: list[str]) -> str:
    """Name each instance and, where it says so, the machine that it runs on."""
    silent = sorted(set(instances) - {info.instance for info in infos})
    return ", ".join([f"{info.instance} on {info.host}" if info.host else info.instance for info in infos] + silent)


def _troubles(name: str, status: Status, source: str) -> Iterator[str]:
    """Yield the problems that a service's own state names; `source` is the source that it reads, in brackets."""
    match State.of(status.state):
        case State.CAMERA_LOST:
            yield (
                f"{name} has the state '{status.state}'{source} and keeps trying to open the camera: check that the "
                "camera is connected and that no other program uses it"
            )
        case State.SOURCE_ENDED:
            endless = "--repetitions 0" if DESCRIPTION in source else "--loop"
            yield (
                f"{name} has the state '{status.state}'{source}: restart {name} to play the source once more, or "
                f"restart {name} with {endless} to repeat the source without end"
            )
        case State.NO_MODEL:
            yield (
                f"{name} has the state '{status.state}' and therefore recognises no action: set --model or ACTUM_MODEL "
                "to a model file"
            )
        case State.MODEL_NOT_RENEWED:
            yield (
                f"{name} has the state '{status.state}' and still uses the previous model, because it cannot load the "
                "changed model file: train the model again, or set another model file"
            )
        case State.NOTHING_TO_DO | State.UNKNOWN_ACTIONS:
            yield f"{name}: {status.state}"


def _remarks(name: str, status: Status) -> Iterator[str]:
    """Yield what a service that does well says of itself besides, and which of its limits were met."""
    met = [f"{kind} {n}" for kind, n in status.rejects.items() if kind.startswith(LIMIT)]
    if met:
        yield (
            f"{name} received more than its limits allow ({', '.join(met)}): find the program that publishes too much; "
            "docs/messages.md explains what each limit does"
        )
    if ignored := status.counts.get(MARKS_IGNORED):
        yield (
            f"{name} has rejected {ignored} start and end marks of actions, because its setting 'segments' was "
            "'auto': to accept marks, set 'segments' to 'both' on the page under Parameters, or start with "
            "--segments both"
        )
    yield from (f"{name}: {remark}" for remark in State.remarks(status.state))


def _versions(info: Info) -> list[str]:
    missing = {schema_name(message) for message in MESSAGES} - set(info.schemas)
    if info.version == __version__ and not missing:
        return []
    lack = f"; it lacks the schemas {', '.join(sorted(missing))}" if missing else ""
    return [
        (
            f"{info.service} is version {info.version}, but this program is version {__version__}: install the same "
            f"version everywhere{lack}"
        )
    ]
