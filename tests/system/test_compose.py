"""The container files: what they say, and what they do on a real engine."""

import json
import re
import signal
import subprocess
import time
from datetime import datetime
from importlib import import_module
from pathlib import Path
from typing import Any

import msgpack
import pytest
import yaml
import zenoh

from actum.health import FRESH_S, is_healthy
from actum_command.processes import GATEWAY, SERVICES, simulated_objects
from actum_command.service_settings import DECLARED, TRAINER
from compose_files import DEPLOY, MAIN, ROOT, services_of
from live import System, free_endpoint, wait_until

ROUTER_CONFIG = DEPLOY / "zenoh" / "router.json5"
SIX = DECLARED.keys() - {GATEWAY, TRAINER}
UNCHECKED = {"demo_model", "watch"}
ACTIONS = {"push", "pull", "put", "lift", "point"}
STOPPED_WITHIN_S = 10.0
HEALTHY_WITHIN_S = 5.0
LARGEST_IMAGE_MB = 350
"""Of any image but the camera's, as `docker image ls` counts."""
COMPOSE_FILES = (MAIN, *sorted(DEPLOY.glob("compose.*.yml")))
OVERLAYS = {"zenohd", "realsense", "openni2", "two-sensors"}
"""Files that are laid over another, whose services they change."""
HARDENED = {
    "init": True,
    "read_only": True,
    "tmpfs": ["/tmp:size=64m"],
    "cap_drop": ["ALL"],
    "security_opt": ["no-new-privileges:true"],
}
LOOSENING = {"read_only", "tmpfs", "cap_drop", "cap_add", "security_opt", "privileged", "user", "mem_limit"}


@pytest.fixture(scope="module")
def services() -> dict[str, dict[str, Any]]:
    return services_of(MAIN)


def test_router_seven_services_demo_model_and_watch_stand_in_one_flat_list(services):
    assert set(services) == {"router", *SIX, TRAINER, *UNCHECKED}
    assert not [name for name, service in services.items() if "depends_on" in service]


@pytest.mark.parametrize("name", sorted(SIX))
def test_each_service_is_built_from_its_own_folder_and_lock(services, name):
    arguments = services[name]["build"]["args"]
    assert arguments["SERVICE"] == name
    assert arguments.get("LOCK", "service") in (name, "service")
    assert services[name]["image"] == f"actum/{name}"


def test_every_image_is_built_once(services):
    images = [service["image"] for service in services.values()]
    built = [service["image"] for service in services.values() if "build" in service]
    assert sorted(built) == sorted(set(images))


def test_only_router_and_page_are_reached_from_outside_and_only_from_this_host(services):
    assert {name: service["ports"] for name, service in services.items() if "ports" in service} == {
        "router": ["127.0.0.1:${ACTUM_ROUTER_PORT:-7447}:7447"],
        "web_dashboard": ["127.0.0.1:${ACTUM_PAGE_PORT:-8080}:8080"],
    }


@pytest.mark.parametrize("file", COMPOSE_FILES, ids=lambda file: file.name)
def test_nobody_is_root_can_write_or_can_take_all_memory(file):
    inherited = {name for name, service in services_of(file).items() if "extends" in service}
    laid_over = file.stem.partition(".")[2] in OVERLAYS
    for name, service in services_of(file).items():
        if laid_over or name in inherited:
            assert not LOOSENING & set(service)
        else:
            assert {key: service.get(key) for key in HARDENED} == HARDENED
            assert set(service) >= {"mem_limit", "pids_limit"}


def test_all_come_back_but_the_copying_of_the_model_and_all_pass_signals_on(services):
    assert {service["restart"] for name, service in services.items() if name != "demo_model"} == {"unless-stopped"}
    assert services["demo_model"]["restart"] == "no"
    assert all(service["init"] for service in services.values())


def test_router_and_six_services_are_checked(services):
    disabled = {name for name, service in services.items() if service.get("healthcheck", {}).get("disable")}
    assert disabled == UNCHECKED


@pytest.mark.parametrize("name", sorted(SIX))
def test_every_variable_is_a_setting_of_its_service(services, name):
    known = import_module(f"{name}.settings").Settings.model_fields
    variables = [variable.removeprefix("ACTUM_").lower() for variable in services[name]["environment"]]
    assert set(variables) <= set(known)
    assert "connect" in variables


def test_the_tracker_knows_the_objects_of_the_simulated_scene(services, monkeypatch):
    settings = import_module("marker_tracker.settings").Settings
    monkeypatch.setenv("ACTUM_OBJECTS", services["marker_tracker"]["environment"]["ACTUM_OBJECTS"])
    told = settings()
    monkeypatch.setenv("ACTUM_OBJECTS", simulated_objects()["ACTUM_OBJECTS"])
    for number, simulated in settings().objects.items():
        assert told.objects[number].name == simulated.name
        assert (told.objects[number].size_m or told.marker_size_m) == simulated.size_m
    assert len(told.objects) == len(settings().objects)


def test_the_demo_model_is_written_where_the_one_who_teaches_takes_it_from(services):
    model = services[TRAINER]["environment"]["ACTUM_ORIGINAL_MODEL"]
    assert services["demo_model"]["command"][0].endswith(f" {model}")
    assert services["demo_model"]["volumes"] == ["models:/models"]
    assert "models:/models:ro" in services["som_classifier"]["volumes"]


def test_what_is_taught_is_put_where_the_classifier_reads_it_and_stays(services):
    trainer, classifier = services[TRAINER], services["som_classifier"]
    assert trainer["environment"]["ACTUM_MODEL"] == classifier["environment"]["ACTUM_MODEL"]
    assert trainer["environment"]["ACTUM_MODEL"] != trainer["environment"]["ACTUM_ORIGINAL_MODEL"], "it is only read"
    assert trainer["environment"]["ACTUM_TRAINER_DATA"].startswith("/models/")
    assert trainer["volumes"] == ["models:/models"]
    assert trainer["entrypoint"] == ["python", "-m", "model_trainer"]
    assert services["demo_model"]["command"][0].startswith("test -e /models/model.npz && exit;")


def test_the_history_that_the_page_adds_has_a_volume_that_its_user_may_write():
    """A named volume takes its owner from the folder in the image."""
    (added,) = re.findall(r"```yaml\n(.*?)```", (ROOT / "docs/operating.md").read_text(encoding="utf-8"), re.DOTALL)
    project = yaml.safe_load(added)
    volume, _, folder = project["services"]["history"]["volumes"][0].partition(":")
    assert volume in project["volumes"]
    assert project["services"]["history"]["command"] == ["record", folder, "--events"]
    (owned,) = re.findall(r"install --directory --owner=actum (.*?) \\\n", (DEPLOY / "service.Dockerfile").read_text())
    assert folder in owned.split()


def test_who_answers_keeps_the_answers_where_they_stay(services):
    keeping = {name for name, service in services.items() if "ACTUM_STATE" in service.get("environment", {})}
    assert keeping == {"som_classifier", "action_fusion"}
    for name in keeping:
        folder = services[name]["environment"]["ACTUM_STATE"]
        assert f"state:{folder}" in services[name]["volumes"]


def test_two_sensors_share_a_container_of_each_service_and_have_a_scene_a_page_and_a_watch_each():
    laid_over = services_of(DEPLOY / "compose.two-sensors.yml")
    sensors = {name: service["environment"]["ACTUM_SENSOR"] for name, service in laid_over.items()}
    of_one = ("scene_simulator", "web_dashboard", "watch")
    assert sensors == {
        **dict.fromkeys((*SERVICES, TRAINER), "left,right"),
        **dict.fromkeys(of_one, "left"),
        **{f"{name}_right": "right" for name in of_one},
    }
    for name in of_one:
        assert laid_over[f"{name}_right"]["extends"] == {"file": "docker-compose.yml", "service": name}


def test_zenohd_reads_the_same_configuration_file(services):
    mounted = services["router"]["volumes"][0].split(":")
    assert (ROOT / mounted[0]).samefile(ROUTER_CONFIG)
    router = services_of(DEPLOY / "compose.zenohd.yml")["router"]
    assert "volumes" not in router
    assert services["router"]["command"][-1] == router["command"][-1] == mounted[1]


def test_the_router_listens_everywhere_inside_its_container():
    config = zenoh.Config.from_file(ROUTER_CONFIG)
    assert json.loads(config.get_json("listen/endpoints")) == ["tcp/0.0.0.0:7447"]
    assert json.loads(config.get_json("mode")) == "router"


def test_our_router_runs_on_the_file_and_is_healthy_while_it_does(running: System, tmp_path: Path, monkeypatch):
    health = tmp_path / "health"
    monkeypatch.setenv("ACTUM_HEALTH_FILE", str(health))
    router = running.start(
        "actum_command", "router", "--config", str(ROUTER_CONFIG), "--listen", running.settings.connect
    )
    with running.client():
        wait_until(lambda: is_healthy(health), "a healthy router")
    router.process.send_signal(signal.SIGSTOP)
    wait_until(lambda: not is_healthy(health), "a frozen router that is not healthy", patience_s=2 * FRESH_S)
    router.process.send_signal(signal.SIGCONT)
    wait_until(lambda: is_healthy(health), "a healthy router")


def engine(*arguments: str) -> str:
    return subprocess.run(["docker", *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def compose(*arguments: str) -> str:
    return engine("compose", "--project-name", "actum-test", *arguments)


def containers() -> list[str]:
    return compose("ps", "--all", "--quiet").split()


def plain_client(port: int) -> zenoh.Session:
    """What any program outside the containers does, with nothing of ours."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["tcp/127.0.0.1:{port}"]')
    return zenoh.open(config)


def recognitions(n: int, port: int) -> list[dict[str, Any]]:
    """The next n events that are no rejections."""
    found: list[dict[str, Any]] = []
    with plain_client(port) as session:
        events = session.declare_subscriber("actum/*/event/**", zenoh.handlers.FifoChannel(64))

        def enough() -> bool:
            while (sample := events.try_recv()) is not None:
                event = msgpack.unpackb(sample.payload.to_bytes())
                found.extend([event] if event["valid"] else [])
            return len(found) >= n

        wait_until(enough, f"{n} recognised actions", patience_s=60)
    return found


def deaths(since_s: float) -> list[dict[str, Any]]:
    """Containers of ours that have ended since then: when, and with which code."""
    filters = ["type=container", "event=die", "label=com.docker.compose.project=actum-test"]
    chosen = [word for condition in filters for word in ("--filter", condition)]
    lines = engine("events", "--since", str(since_s), "--until", str(time.time()), "--format", "{{json .}}", *chosen)
    return [json.loads(line) for line in lines.splitlines()]


@pytest.mark.containers
@pytest.mark.parametrize(
    "files",
    [
        ["docker-compose.yml"],
        *(["docker-compose.yml", f"deploy/compose.{name}.yml"] for name in ("zenohd", "two-sensors")),
    ],
)
def test_compose_accepts(files):
    resolved = engine("compose", *(word for file in files for word in ("-f", file)), "config", "--format", "json")
    published = {name: s["ports"] for name, s in json.loads(resolved)["services"].items() if "ports" in s}
    reached = {"router", "web_dashboard", "web_dashboard_right"}
    assert all(name in reached and len(ports) == 1 for name, ports in published.items())
    assert len({ports[0]["published"] for ports in published.values()}) == len(published)
    router = json.loads(resolved)["services"].get("router", {})
    assert router.get("image", "").startswith("eclipse/zenoh:") is ("deploy/compose.zenohd.yml" in files)
    assert ("build" in router) is (router.get("image") == "actum/actum_command")


def image_sizes_mb() -> dict[str, float]:
    images = {service["image"] for service in services_of(MAIN).values()}
    return {image: int(engine("image", "inspect", "--format", "{{.Size}}", image)) / 1e6 for image in images}


def healthy_after_s(service: str) -> float:
    """How long a service that was just started takes to be healthy, at the ends of its health checks."""
    health = ["inspect", "--format", "{{json .State}}", compose("ps", "--quiet", service).strip()]
    wait_until(lambda: json.loads(engine(*health))["Health"]["Status"] == "healthy", f"{service} is healthy")
    state = json.loads(engine(*health))
    began = datetime.fromisoformat(state["StartedAt"])
    ends = [datetime.fromisoformat(check["End"]) for check in state["Health"]["Log"] if check["ExitCode"] == 0]
    return min((end - began).total_seconds() for end in ends if end > began)


@pytest.fixture
def project(monkeypatch):
    """Everything up, on ports of this machine that nobody has; the router's port."""
    router, page = (free_endpoint().rpartition(":")[2] for _ in range(2))
    monkeypatch.setenv("ACTUM_ROUTER_PORT", router)
    monkeypatch.setenv("ACTUM_PAGE_PORT", page)
    try:
        compose("up", "--build", "--detach")
        yield int(router)
    finally:
        compose("down", "--volumes")


@pytest.mark.containers
@pytest.mark.timeout(1200)
def test_up_recognises_and_down_leaves_nothing(project):
    compose("up", "--detach", "--wait", "--wait-timeout", "120", "router", *SIX)
    print(compose("ps", "--format", "table {{.Service}}\t{{.Status}}"))
    assert engine("wait", *compose("ps", "--all", "--quiet", "demo_model").split()) == "0\n"
    users = {name: compose("exec", "-T", name, "id", "-u").strip() for name in ("router", *SIX)}
    assert set(users.values()) == {"10001"}
    for image, size_mb in image_sizes_mb().items():
        print(f"{image}: {size_mb:.0f} MB")
        assert size_mb < LARGEST_IMAGE_MB

    for name in ("router", *sorted(SIX)):
        compose("restart", name)
        took_s = healthy_after_s(name)
        print(f"{name}: healthy after {took_s:.1f} s")
        assert took_s < HEALTHY_WITHIN_S

    events = recognitions(3, port=project)
    for event in events:
        print(event["sentence"])
        assert event["action"] in ACTIONS
        assert event["sentence"].startswith(event["action"])
        assert event["objects_present"]

    began_s = time.time()
    compose("down")
    print(f"docker compose down: {time.time() - began_s:.1f} s")
    ended = deaths(began_s)
    assert len(ended) == len({"router", "watch", TRAINER, *SIX})
    assert {end["Actor"]["Attributes"]["exitCode"] for end in ended} == {"0"}
    assert max(end["timeNano"] for end in ended) / 1e9 - began_s < STOPPED_WITHIN_S
    assert containers() == []
