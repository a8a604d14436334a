"""What `actum doctor` finds of real processes that have the very fault."""

import json
import re
import socket
from pathlib import Path

import pytest
from benchmarks.rig.tcp_proxy import TcpProxy

import wall_clocks
from actum import __version__, keys
from live import System, collect, described, system, wait_until
from people import reaches
from sensors import recording
from wall_clocks import WallClock

pytestmark = pytest.mark.system
TESTS = Path(__file__).parents[1]
MESSAGES = [
    "put", "delete", "declare_subscriber", "query", "declare_queryable", "reply", "liveliness_token",
    "declare_liveliness_subscriber", "liveliness_query",
]  # fmt: skip
"""All that Zenoh's access control knows."""


def said(running: System) -> str:
    """What doctor prints of a system in which something is wrong."""
    examined = running.actum("doctor")
    assert examined.returncode == 1, examined.stdout + examined.stderr
    return " ".join(examined.stdout.split())


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("slow", r"sensor_gateway publishes ([1-9]|1[0-2]) frames per second, but its source is set to 30"),
        ("frozen", "all skeletons are identical, so the camera is frozen"),
        ("frozen", "all images are identical, so the camera is frozen"),
        ("still", "the time stamps of the skeletons do not increase"),
        ("stopped", "sensor_gateway stopped publishing image/color after 5 messages"),
    ],
)
def test_a_gateway_with_a_fault(running: System, fault: str, words: str) -> None:
    running.start_router()
    running.start_script(TESTS / "faulty_gateway.py", fault)
    with running.client() as client:
        running.wait_for_services(client, "sensor_gateway")
        assert re.search(words, said(running))


def test_a_gateway_without_a_fault(running: System) -> None:
    running.start_router()
    running.start("scene_simulator", "--repetitions", "0")
    running.start("pose_preprocessor")
    with running.client() as client:
        running.wait_for_services(client, "sensor_gateway", "pose_preprocessor")
        found = said(running)  # other services are missing
    for word in ("per second", "identical", "do not increase", "stopped publishing", "clock", "access control"):
        assert word not in found


def test_a_recording_that_is_played_too_slowly(running: System, tmp_path: Path) -> None:
    recording(tmp_path / "reaches.mcap", *reaches(400))
    running.start_router()
    running.start("pose_preprocessor")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        skeletons = client.listen(keys.pattern(keys.SKELETON, client.sensor))
        running.start("actum_command", "play", str(tmp_path / "reaches.mcap"), "--speed", "0.1")
        wait_until(lambda: skeletons.receive() is not None, "it is played")
        found = said(running)
        assert "3 skeletons arrive per second, but their time stamps show that the sensor captured 30" in found, found


def test_a_service_of_another_version(running: System) -> None:
    running.start_router()
    running.start_script(TESTS / "older_preprocessor.py")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        assert (
            f"pose_preprocessor is version 0.0.9, but this program is version {__version__}: install the same"
            in said(running)
        )


@pytest.mark.skipif(wall_clocks.missing() is not None, reason=wall_clocks.missing() or "")
def test_a_clock_that_is_ahead_is_told_and_is_no_problem(running: System, tmp_path: Path) -> None:
    running.start_router()
    running.variables = WallClock(tmp_path / "clock", 5.0).variables
    running.start("pose_preprocessor")
    running.variables = {}
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        found = said(running)
    assert f"the clock of {socket.gethostname()} is 5.0" in found
    assert re.search(r"s \(± 0\.0\d+ s\) ahead of the clock of this host", found)


def router_that_allows(running: System, folder: Path, ingress: list[str], egress: list[str]) -> None:
    """Start a router that lets everybody in, and lets pass what is named."""
    flows = {"ingress": ingress, "egress": egress}
    everything = [f"{keys.BASE}/**", f"{keys.BASE}/**/@adv/**"]
    rules = [
        {"id": flow, "permission": "allow", "flows": [flow], "messages": messages, "key_exprs": everything}
        for flow, messages in flows.items()
        if messages
    ]
    policies = [{"rules": [rule["id"] for rule in rules], "subjects": ["all"]}] if rules else []
    control = {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [{"id": "all"}],
        "policies": policies,
    }
    configured = folder / "router.json5"
    adminspace = {"enabled": True, "permissions": {"read": True, "write": False}}
    configured.write_text(json.dumps({"mode": "router", "adminspace": adminspace, "access_control": control}))
    running.start("actum_command", "router", "--config", str(configured), "--listen", running.settings.connect)


def started_behind(running: System) -> None:
    preprocessor = running.start("pose_preprocessor")
    wait_until(lambda: "connected to" in preprocessor.said(), "it has a session")
    with running.client() as client:
        client.offers("pose_preprocessor", timeout_s=5.0)


def test_a_router_that_tells_nothing_is_not_one_behind_which_nothing_runs(running: System, tmp_path: Path) -> None:
    router_that_allows(running, tmp_path, [], [])
    started_behind(running)
    assert said(running).startswith("the router lets this program connect but answers none of its queries")


def test_behind_a_router_that_tells_all_nothing_runs(running: System) -> None:
    running.start_router()
    found = said(running)
    assert "pose_preprocessor is not running: start it" in found
    assert "access control" not in found


def test_a_role_that_may_not_look_is_told_that_services_run(running: System, tmp_path: Path) -> None:
    """As a role of the table to which everybody's wishes are told, and nothing else."""
    blind = [message for message in MESSAGES if message not in ("liveliness_token", "reply", "put")]
    router_that_allows(running, tmp_path, MESSAGES, blind)
    started_behind(running)
    assert said(running).startswith("services run, but the router's access control denies this program permission")


def test_a_role_that_is_told_in_part(running: System, tmp_path: Path) -> None:
    router_that_allows(running, tmp_path, [m for m in MESSAGES if m != "liveliness_query"], MESSAGES)
    preprocessor = running.start("pose_preprocessor", "--take-over")
    with running.client() as client:
        collect(client.listen(keys.pattern(keys.STATUS, client.sensor)), object, bool)  # type: ignore[arg-type]
    assert preprocessor.process.poll() is None
    assert (
        "services run, but the router's access control denies this program permission to read their liveliness tokens"
        in said(running)
    )


def test_two_of_one_name_behind_two_routers(running: System, tmp_path: Path) -> None:
    """Each has its place while the routers are apart; when they are linked, nobody of one name gives way."""
    running.start_router()
    port = int(running.settings.connect.rpartition(":")[2])
    (tmp_path / "far").mkdir()
    with TcpProxy(port) as link, system(tmp_path / "far") as far:
        link.cut()
        linked = tmp_path / "linked.json5"
        linked.write_text(json.dumps({"mode": "router", "connect": {"endpoints": [f"tcp/127.0.0.1:{link.port}"]}}))
        far.start("actum_command", "router", "--config", str(linked), "--listen", far.settings.connect)
        for each in (running, far):
            each.start("pose_preprocessor", "--instance", "one")
            with each.client() as client:
                described(client)
        link.mend()
        with running.client() as client:
            wait_until(lambda: len(client.infos()) == 2, "the routers are linked")
            found = said(running)
    assert "more than one instance of pose_preprocessor runs" in found
    assert found.count("one on") == 2
