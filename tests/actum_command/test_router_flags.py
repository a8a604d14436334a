"""Commands that talk to a router take its endpoint as a flag, which they hand on to the processes that they start."""

import re

import pytest
from typer.testing import CliRunner

from actum.settings import ServiceSettings
from actum_command.__main__ import app
from actum_command.supervising import Program
from command_lines import invoke

NAMED = ["--connect", "tcp/127.0.0.1:9", "--sensor", "door"]


def test_the_flags_are_stronger_than_the_environment_and_reach_every_process(
    started: list[Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ACTUM_CONNECT", "tcp/127.0.0.1:1")
    monkeypatch.setenv("ACTUM_SENSOR", "window")
    done = invoke("up", *NAMED)
    assert "actum starts on tcp/127.0.0.1:9, sensor door" in done.stdout
    told = {(each.environment["ACTUM_CONNECT"], each.environment["ACTUM_SENSOR"]) for each in started}
    assert told == {("tcp/127.0.0.1:9", "door")}
    assert ServiceSettings().connect == "tcp/127.0.0.1:9"


@pytest.mark.parametrize(
    "command",
    ["demo", "up", "record", "play", "scene", "watch", "ros2", "view", "foxglove", "doctor", "segment toggle"],
)
def test_each_command_that_talks_to_a_router_has_them(command: str) -> None:
    shown = CliRunner().invoke(app, [*command.split(), "--help"], env={"COLUMNS": "200"}).output
    assert shown.count("--connect ") == len(re.findall(r"--sensor(?:,--sensors)? ", shown)) == 1


def test_what_is_no_endpoint_is_refused_as_in_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_CONNECT", "tcp/127.0.0.1:1")
    refused = invoke("doctor", "--connect", "nowhere")
    assert refused.exit_code == 1
    assert "'nowhere' is not an endpoint" in refused.stderr
