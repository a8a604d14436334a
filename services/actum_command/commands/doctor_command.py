"""`actum doctor`: checks that every service is there, alive and of one version."""

import os
from collections.abc import Callable, Iterator
from operator import attrgetter

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Column, Table

from actum.settings import NodeSettings, ServiceSettings
from actum_command.commands.terminal import connect, console, say, settings
from actum_command.doctor.diagnosis import examine
from actum_command.doctor.service_checks import Finding
from actum_command.misspelt import misspelt

TABLE_WIDTH = 100  # characters that the table needs so that no word is broken
LATENCY = "latency p50/p99 (ms)"
"""A heading that is longer than what stands below it."""
WIDTHS = {LATENCY: 15}
"""Most characters of a column, so that those with more to say have room."""
SOURCES = {"sensor_gateway": "sensor", "ros2_bridge": "sensor", "marker_camera": "marker camera"}
"""The name of a service's source in the output."""


def doctor() -> None:
    """Check the running system, and print what is wrong.

    The command checks the router, services, streams, versions, clocks and settings. Run this command when events are
    missing. The exit code is 1 if the command finds a problem. With --sensors left,right, the command checks each
    sensor in turn.
    """
    each = settings(NodeSettings).of_each_sensor
    are_well = []
    for here in each:
        if len(each) > 1:
            say(f"sensor {here.sensor}", style="bold")
        are_well.append(_is_well(here))
    misspellings = list(misspelt(os.environ))
    for line in misspellings:
        say(line, style="red")
    if misspellings or not all(are_well):
        raise typer.Exit(1)
    console.print("[green]all services are there, alive and of one version[/green]")


def _is_well(here: ServiceSettings) -> bool:
    """Examine the services of one sensor, print what was found, and return whether it is no problem."""
    with connect(here=here) as client:
        found = examine(client)
    show(found.findings, console)
    for fact in found.facts:
        console.print(fact, markup=False, soft_wrap=True)
    for remark in (*(remark for finding in found.findings for remark in finding.remarks), *found.remarks):
        say(remark, style="yellow")
    problems = [*(problem for finding in found.findings for problem in finding.problems), *found.problems]
    for problem in problems:
        say(problem, style="red")
    return not problems


def show(findings: list[Finding], console: Console) -> None:
    """Print the findings, as a table if the console is wide enough, and the source of each service that has one."""
    if findings and console.width >= TABLE_WIDTH:
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
    own = (Column(name, overflow="fold", max_width=WIDTHS.get(name)) for name in columns)
    result = Table(Column("service", no_wrap=True), "alive", *own)
    for finding in findings:
        cells = (escape(cell(finding)) for cell in columns.values())
        result.add_row(escape(finding.service), _coloured(finding, f"{finding.instances or 'no'}"), *cells)
    return result


def paragraphs(findings: list[Finding]) -> Iterator[str]:
    """Yield the findings as lines, for a console that is too narrow for the table."""
    columns = _columns(findings)
    for finding in findings:
        yield f"{_coloured(finding, escape(finding.service))}, {finding.instances or 'none'} alive"
        cells = {name: cell(finding) for name, cell in columns.items()}
        yield from (f"  {name}: {escape(text)}" for name, text in cells.items() if text)


def _coloured(finding: Finding, text: str) -> str:
    colour = "red" if finding.problems else "green"
    return f"[{colour}]{text}[/{colour}]"


def _columns(findings: list[Finding]) -> dict[str, Callable[[Finding], str]]:
    """Return the function that reads each column from a finding, by heading; rare ones only where there are any."""
    columns: dict[str, Callable[[Finding], str]] = {
        "version": attrgetter("version"),
        "state": attrgetter("state"),
        "rates (Hz)": attrgetter("rates"),
        "rejected": attrgetter("rejects"),
        "dropped": attrgetter("drops"),
        "counted": attrgetter("counts"),
        LATENCY: attrgetter("latency"),
    }
    for rare in ("rejected", "dropped", "counted"):
        if not any(columns[rare](finding) for finding in findings):
            del columns[rare]
    return columns
