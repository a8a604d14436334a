"""`actum doctor`: is everything there, alive, and of one version?"""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from operator import attrgetter

from rich.console import Console
from rich.markup import escape
from rich.table import Column, Table

from actum import __version__, keys
from actum.codec import schema_name
from actum.messages import MESSAGES, Info, Status
from actum.runtime import Client

EXPECTED = ("sensor_gateway", "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion")
STATUS_S = 2.5
TABLE_WIDTH = 100
ENDED = "source ended"
NO_MODEL = "no model"
OLD_MODEL = "model not renewed"
SOURCES = {"sensor_gateway": "sensor", "marker_camera": "marker camera"}


@dataclass(frozen=True)
class Finding:
    """One service as it was found."""

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


def examine(client: Client) -> list[Finding]:
    """Look at every service that is expected or found alive."""
    statuses = _statuses(client)
    tokens: dict[str, list[str]] = {}
    for key in client.alive():
        service, instance = key.split("/")[-2:]
        tokens.setdefault(service, []).append(instance)
    infos = client.infos()
    names = [*EXPECTED, *sorted(tokens.keys() - set(EXPECTED))]
    return [
        _finding(name, tokens.get(name, []), [info for info in infos if info.service == name], statuses.get(name))
        for name in names
    ]


def show(findings: list[Finding], console: Console) -> None:
    """Print what was found, as wide as the console allows, and what the sensor is."""
    if console.width >= TABLE_WIDTH:
        console.print(table(findings))
    else:
        console.print("\n".join(paragraphs(findings)))
    for finding in findings:
        if finding.source:
            label = SOURCES.get(finding.service, finding.service)
            console.print(f"{label}: {finding.source}", markup=False, soft_wrap=True)


def table(findings: list[Finding]) -> Table:
    """Lay the findings out, one service a row."""
    columns = _columns(findings)
    result = Table(Column("service", no_wrap=True), "alive", *(Column(name, overflow="fold") for name in columns))
    for finding in findings:
        cells = (escape(cell(finding)) for cell in columns.values())
        result.add_row(escape(finding.service), _coloured(finding, f"{finding.instances or 'no'}"), *cells)
    return result


def paragraphs(findings: list[Finding]) -> Iterator[str]:
    """Say the same in lines, for a console that has no room for a table."""
    columns = _columns(findings)
    for finding in findings:
        yield f"{_coloured(finding, escape(finding.service))}, {finding.instances or 'none'} alive"
        told = {name: cell(finding) for name, cell in columns.items()}
        yield from (f"  {name}: {escape(text)}" for name, text in told.items() if text)


def _coloured(finding: Finding, text: str) -> str:
    colour = "red" if finding.problems else "green"
    return f"[{colour}]{text}[/{colour}]"


def _columns(findings: list[Finding]) -> dict[str, Callable[[Finding], str]]:
    """What is told of each service; drops where there are any."""
    columns: dict[str, Callable[[Finding], str]] = {
        "version": attrgetter("version"),
        "state": attrgetter("state"),
        "rates (Hz)": attrgetter("rates"),
        "rejected": attrgetter("rejects"),
        "dropped": attrgetter("drops"),
        "latency p50/p99 (ms)": attrgetter("latency"),
    }
    if not any(finding.drops for finding in findings):
        del columns["dropped"]
    return columns


def _statuses(client: Client) -> dict[str, Status]:
    """Collect what each service says of itself within a little over two reports."""
    found: dict[str, Status] = {}
    listening = client.listen(keys.pattern(keys.STATUS, client.sensor))
    deadline = time.monotonic() + STATUS_S
    while time.monotonic() < deadline:
        received = listening.take()
        if received is None:
            time.sleep(0.02)
        elif isinstance(received.message, Status):
            found[received.message.service] = received.message
    return found


def _finding(name: str, instances: list[str], infos: list[Info], status: Status | None) -> Finding:
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
    )


def _rates(status: Status) -> str:
    return ", ".join(f"{_short(key, status)} {rate:g}" for key, rate in status.rates.items())


def _short(key: str, status: Status) -> str:
    return key.removeprefix(f"{keys.BASE}/{status.sensor}/")


def _latency(latency_ms: Mapping[str, float]) -> str:
    """Write both percentiles, a dash for one that a foreign service does not tell."""
    if not latency_ms:
        return ""
    return " / ".join(f"{latency_ms[name]:.2f}" if name in latency_ms else "-" for name in ("p50", "p99"))


def _problems(name: str, instances: list[str], infos: list[Info], status: Status | None) -> Iterator[str]:
    if not instances:
        yield f"{name} is not running: start it with 'python -m {name}' or 'actum up'"
        return
    if len(instances) > 1 or len(infos) > 1:
        who = _who(infos, instances)
        yield f"{name} runs more than once, so everything is answered more than once: stop all but one of {who}"
    if status is None:
        yield f"{name} is alive but sent no status in {STATUS_S:g} s"
    else:
        yield from _troubles(name, status, next((f" ({info.source})" for info in infos if info.source), ""))
    if not infos:
        yield f"{name} does not answer on its info key"
    yield from dict.fromkeys(line for info in infos for line in _versions(info))


def _who(infos: list[Info], instances: list[str]) -> str:
    """Name each process and, where it tells, the machine it runs on."""
    silent = sorted(set(instances) - {info.instance for info in infos})
    return ", ".join([f"{info.instance} on {info.host}" if info.host else info.instance for info in infos] + silent)


def _troubles(name: str, status: Status, source: str) -> Iterator[str]:
    """Say what is wrong by the service's own account; `source` names what it reads."""
    if status.state.startswith("camera lost"):
        yield f"{name}: {status.state}{source}; it tries again by itself"
    elif status.state == ENDED:
        yield f"{name}: {status.state}{source}; start it again for more, with --loop for more and more"
    elif status.state.startswith(NO_MODEL):
        yield f"{name}: {status.state}, so every action is rejected; name one in --model or ACTUM_MODEL"
    elif status.state.startswith(OLD_MODEL):
        yield f"{name}: {status.state}; it goes on with the model before"


def _versions(info: Info) -> list[str]:
    missing = {schema_name(message) for message in MESSAGES} - set(info.schemas)
    if info.version == __version__ and not missing:
        return []
    lack = f"; it lacks {', '.join(sorted(missing))}" if missing else ""
    return [f"{info.service} is version {info.version}, this is {__version__}: install the same everywhere{lack}"]
