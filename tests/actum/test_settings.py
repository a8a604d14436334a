"""Settings that cannot be used are refused, naming what is wrong."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pydantic import ValidationError

from actum.command_line import from_command_line
from actum.runtime.serving import INTERRUPTED, UNUSABLE, configured, log_level
from actum.runtime.session import client_config
from actum.settings import ServiceSettings, SettingsError, complaint, host_and_port
from marker_tracker.settings import Settings as TrackerSettings

SERVICES = Path(__file__).parents[2] / "services"


@pytest.mark.parametrize(
    ("endpoint", "address"),
    [
        ("tcp/127.0.0.1:7447", ("127.0.0.1", 7447)),
        ("tcp/router:0", ("router", 0)),
        ("tcp/[::]:7552", ("::", 7552)),
        ("tls/[::1]:65535", ("::1", 65535)),
        ("udp/10.0.0.1:7447?rel=0#iface=eth0", ("10.0.0.1", 7447)),
        ("unixsock-stream//tmp/actum.sock", None),
    ],
)
def test_an_endpoint_is_a_transport_and_where_to(endpoint: str, address: tuple[str, int] | None) -> None:
    assert host_and_port(endpoint) == address


@pytest.mark.parametrize(
    "endpoint", ["", "foo", "tcp/", "tcp/host", "127.0.0.1:7551", "udp7551", "tcp/h:65536", "tcp/h:-1", "tpc/h:1"]
)
def test_what_is_no_endpoint_is_refused_by_name_with_the_form(endpoint: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_CONNECT", endpoint)
    with pytest.raises(ValidationError) as refused:
        ServiceSettings()
    assert complaint(refused.value).startswith(f"settings: connect: {endpoint!r} is not an endpoint: use tcp/host:port")


def test_the_file_that_is_named_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "actum.toml").write_text('sensor = "door"')
    monkeypatch.setenv("ACTUM_CONFIG", str(tmp_path / "actum.toml"))
    assert ServiceSettings().sensor == "door"


@pytest.mark.parametrize("content", [None, b"sensor: door", b"sensor = '\xff'"])
def test_a_file_that_is_named_and_cannot_be_read_is_refused_by_name(
    content: bytes | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "actum.toml"
    if content is not None:
        file.write_bytes(content)
    monkeypatch.setenv("ACTUM_CONFIG", str(file))
    with pytest.raises(SettingsError, match=f"ACTUM_CONFIG names {file}"):
        ServiceSettings()


@pytest.mark.parametrize("content", [None, "{ mode: ", "{ moode: 3 }"])
def test_a_zenoh_configuration_that_cannot_be_used_is_refused_by_name(content: str | None, tmp_path: Path) -> None:
    file = tmp_path / "zenoh.json5"
    if content is not None:
        file.write_text(content)
    with pytest.raises(SettingsError, match=r"zenoh\.json5 is not a valid Zenoh configuration") as refused:
        client_config(ServiceSettings(zenoh_config=file))
    assert "\n" not in str(refused.value)


PYTHONS_WORDS = re.compile(
    r"default factory|typing|pathlib|<class|None|\\b(str|int|float|bool|list|dict|tuple|frozenset)\\b[\\[(]?"
)


@pytest.mark.parametrize(
    "service",
    ["sensor_gateway", "scene_simulator", "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion"],
)
def test_a_service_explains_its_flags_without_pythons_types(
    service: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", [service, "--help"])
    monkeypatch.setenv("COLUMNS", "200")
    with pytest.raises(SystemExit) as ended:
        from_command_line(importlib.import_module(f"{service}.settings").Settings, service)
    assert ended.value.code == 0
    shown = capsys.readouterr().out
    assert "--connect TEXT" in shown
    assert PYTHONS_WORDS.findall(shown) == []


def test_flags_come_before_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_SENSOR", "door")
    monkeypatch.setattr("sys.argv", ["service"])
    assert from_command_line(ServiceSettings, "service").sensor == "door"
    monkeypatch.setattr("sys.argv", ["service", "--sensor", "window"])
    assert from_command_line(ServiceSettings, "service").sensor == "window"


AS_IN_A_CONTAINER = """
import os, socket
os.getpid, socket.gethostname = lambda: 1, lambda: "raspberrypi"
from actum.settings import ServiceSettings
print(ServiceSettings().instance, ServiceSettings().instance)
"""
"""Two hosts that were installed alike have one name, and each container's process is the first."""


def test_two_processes_have_two_instance_names_also_where_host_and_process_id_are_the_same() -> None:
    names = [
        set(
            subprocess.run(
                [sys.executable, "-c", AS_IN_A_CONTAINER], capture_output=True, text=True, check=True
            ).stdout.split()
        )
        for _ in range(2)
    ]
    assert [len(each) for each in names] == [1, 1]
    assert names[0] != names[1]


def every_number() -> list[tuple[type[ServiceSettings], str]]:
    """Each service's settings that are numbers with a fraction, perhaps in a list or a map."""
    names = [
        ".".join(file.relative_to(SERVICES).with_suffix("").parts) for file in sorted(SERVICES.rglob("settings.py"))
    ]
    kinds = [importlib.import_module(name).Settings for name in names]
    return [
        (kind, name) for kind in kinds for name, field in kind.model_fields.items() if "float" in str(field.annotation)
    ]


@pytest.mark.parametrize("value", ["inf", "-inf", "nan", "1e999"])
@pytest.mark.parametrize(("kind", "name"), every_number())
def test_a_number_that_is_not_finite_is_refused_from_wherever_it_comes(
    kind: type[ServiceSettings], name: str, value: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = f"wave={value}" if name == "cooldown_s" else value
    with pytest.raises(ValidationError, match=name):
        from_command_line(kind, "service", [f"--{name.replace('_', '-')}={written}"])
    with monkeypatch.context() as patch, pytest.raises(ValidationError, match=name):
        patch.setenv(f"ACTUM_{name.upper()}", written)
        kind()
    (tmp_path / "actum.toml").write_text(f"{name} = {'{wave = inf}' if name == 'cooldown_s' else value}\n")
    monkeypatch.setenv("ACTUM_CONFIG", str(tmp_path / "actum.toml"))
    with pytest.raises(ValidationError, match=name):
        kind()


def test_a_size_of_a_marker_that_is_not_finite_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_OBJECTS", '{"3": {"name": "cup", "size_m": NaN}}')
    with pytest.raises(ValidationError, match="size_m"):
        TrackerSettings()


@pytest.mark.parametrize(("level", "used"), [("debug", "DEBUG"), ("", "INFO"), ("Warning", "WARNING")])
def test_a_log_level_is_taken_however_it_is_written(level: str, used: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_LOG", level)
    assert log_level() == used


def test_a_log_level_that_there_is_not_is_refused_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ACTUM_LOG", "verbose")
    with pytest.raises(SystemExit) as ended:
        configured(ServiceSettings, lambda _: None, [])
    assert ended.value.code == UNUSABLE
    assert "ACTUM_LOG: 'verbose' is not a log level" in capsys.readouterr().err


def test_an_interrupt_while_a_service_is_built_ends_it_without_a_traceback() -> None:
    def interrupted(_: ServiceSettings) -> None:
        raise KeyboardInterrupt

    with pytest.raises(SystemExit) as ended:
        configured(ServiceSettings, interrupted, [])
    assert ended.value.code == INTERRUPTED
