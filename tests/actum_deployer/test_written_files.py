"""The folders that are written: who may read them, what each host gets, and what Zenoh and Compose read."""

from pathlib import Path
from typing import Any

import pytest
import yaml
import zenoh

from actum.installing import WHEEL
from actum.runtime.credentials import check
from actum.runtime.router import router_config
from actum.settings import SettingsError
from actum_deployer.credential_folders import SERVICES_USER
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.writing import write_deployment
from compose_files import DEPLOY, MAIN, services_of

HOSTS = hosts_of("camera=192.168.1.5,compute=192.168.1.6")
CAMERA = DEPLOY / "compose.camera-host.yml"
USUAL = Path(__file__).parents[2] / "deploy" / "zenoh" / "router.json5"


@pytest.fixture
def written(tmp_path: Path) -> Path:
    write_deployment(Deployment(HOSTS, passwords=True), tmp_path, days=30)
    return tmp_path


def compose(root: Path, host: str) -> dict[str, Any]:
    return yaml.safe_load((root / host / "compose.yml").read_text())["services"]


def test_each_host_has_the_credentials_of_its_services_and_no_others(written: Path) -> None:
    assert {each.name for each in (written / "camera" / "credentials").iterdir()} == {
        "router", "gateway.kinect0", "tracker.kinect0",
    }  # fmt: skip
    assert {each.name for each in (written / "compute" / "credentials").iterdir()} == {
        "router", "preprocessor.kinect0", "classifier.kinect0", "fusion.kinect0", "trainer.kinect0", "page.kinect0",
    }  # fmt: skip
    assert {each.name for each in (written / "people").iterdir()} == {"switch", "viewer", "recorder"}


@pytest.mark.parametrize("host", ["camera", "compute"])
def test_a_container_has_its_own_credentials_and_no_rights(written: Path, host: str) -> None:
    for name, service in compose(written, host).items():
        assert service["read_only"], name
        assert service["cap_drop"] == ["ALL"]
        assert service["security_opt"] == ["no-new-privileges:true"]
        assert service["user"] == f"{SERVICES_USER}:{SERVICES_USER}"
        assert {"mem_limit", "pids_limit", "tmpfs"} <= service.keys()
        [mounted] = [mount for mount in service["volumes"] if "credentials" in mount]
        source, target, mode = mounted.split(":")
        assert (mode, target) == ("ro", service["environment"]["ACTUM_CREDENTIALS"])
        check(written / host / source)


def test_a_container_may_use_as_much_as_in_the_compose_files_of_the_repository(written: Path) -> None:
    usual = {name: _megabytes(service["mem_limit"]) for name, service in services_of(MAIN).items()}
    usual |= {"sensor_gateway": _megabytes(services_of(CAMERA)["sensor_gateway"]["mem_limit"])}
    for host in ("camera", "compute"):
        for name, service in compose(written, host).items():
            assert _megabytes(service["mem_limit"]) == usual[name], name


def _megabytes(limit: str) -> int:
    return int(limit[:-1]) * {"m": 1, "g": 1024}[limit[-1]]


def test_no_image_is_pulled_by_a_name_that_is_not_ours_on_docker_hub(written: Path) -> None:
    files = [MAIN, *DEPLOY.glob("compose.*.yml"), *written.glob("*/compose.yml")]
    policies = {
        f"{file.relative_to(file.parents[1])}: {name}": service.get("pull_policy")
        for file in files
        for name, service in services_of(file).items()
        if service.get("image", "").startswith("actum/")
    }
    assert len(policies) > 20
    assert {place for place, policy in policies.items() if policy != "never"} == set()


def test_root_installs_a_wheel_that_was_copied_and_nothing_by_name(written: Path) -> None:
    for host in ("camera", "compute"):
        assert f"pip install '{WHEEL}[all]'" in (written / host / "README.md").read_text()


def test_only_the_router_is_reached_from_elsewhere(written: Path) -> None:
    for host in ("camera", "compute"):
        for name, service in compose(written, host).items():
            for port in service.get("ports", []):
                assert name == "router" or port.startswith("127.0.0.1:")


def test_a_unit_for_each_container_starts_the_same(written: Path) -> None:
    for host in ("camera", "compute"):
        units = {
            file.stem.removeprefix("actum-"): file.read_text()
            for file in (written / host / "systemd").glob("*.service")
        }
        services = compose(written, host)
        assert units.keys() == services.keys()
        for name, text in units.items():
            assert f"ACTUM_CREDENTIALS={services[name]['environment']['ACTUM_CREDENTIALS']}" in text
            assert "NoNewPrivileges=yes" in text
            assert f"actum-{name}" in (written / host / "README.md").read_text()


@pytest.mark.parametrize("options", [{}, {"passwords": True}, {"secured": False}, {"images_cross": True}], ids=str)
def test_zenoh_reads_every_routers_file(options: dict[str, bool], tmp_path: Path) -> None:
    deployment = Deployment(HOSTS, **options)
    write_deployment(deployment, tmp_path, days=30)
    for host in deployment.routers:
        credentials = tmp_path / host.name / "credentials" / "router" if deployment.secured else None
        config = router_config(None, tmp_path / host.name / "router.json5", credentials)
        assert ("true" in config.get_json("access_control/enabled")) == deployment.secured
        assert isinstance(config, zenoh.Config)


def test_with_one_router_the_others_connect_to_it(tmp_path: Path) -> None:
    write_deployment(Deployment(HOSTS, one_router=True), tmp_path, days=30)
    assert "router" not in compose(tmp_path, "compute")
    assert not (tmp_path / "compute" / "router.json5").exists()
    assert compose(tmp_path, "compute")["som_classifier"]["environment"]["ACTUM_CONNECT"] == "tls/192.168.1.5:7447"


SHARED = ("pose_preprocessor", "som_classifier", "action_fusion", "model_trainer")
"""The services of a host that computes which are one process for all of its sensors."""


@pytest.fixture
def two_sensors(tmp_path: Path) -> Path:
    hosts = hosts_of("camera1=a,camera2=b,compute=c", "left,right")
    write_deployment(Deployment(hosts, simulated=True), tmp_path, days=30)
    return tmp_path


def test_a_host_computes_for_all_of_its_sensors_by_one_process_of_each_service_and_a_page_for_each(
    two_sensors: Path,
) -> None:
    services = compose(two_sensors, "compute")
    assert services.keys() == {"router", *SHARED, "web_dashboard-left", "web_dashboard-right"}
    for name in SHARED:
        environment = services[name]["environment"]
        assert environment["ACTUM_SENSOR"] == "left,right"
        assert environment["ACTUM_CREDENTIALS"].endswith(".left+right")
    pages = [services[f"web_dashboard-{sensor}"] for sensor in ("left", "right")]
    assert [page["ports"] for page in pages] == [["127.0.0.1:8080:8080"], ["127.0.0.1:8081:8081"]]
    assert [page["environment"]["ACTUM_SENSOR"] for page in pages] == ["left", "right"]


def test_each_sensors_host_has_its_own_source_and_tracker_and_simulated_scenes_differ(two_sensors: Path) -> None:
    for host, sensor in (("camera1", "left"), ("camera2", "right")):
        services = compose(two_sensors, host)
        assert services.keys() == {"router", "sensor_gateway", "marker_tracker"}
        for name in ("sensor_gateway", "marker_tracker"):
            assert services[name]["environment"]["ACTUM_SENSOR"] == sensor
            assert services[name]["environment"]["ACTUM_CREDENTIALS"].endswith(f".{sensor}")
    settings = [(two_sensors / host / "settings.env").read_text() for host in ("camera1", "camera2")]
    assert ["ACTUM_SEED=2" in text for text in settings] == [False, True]


def test_the_sensors_of_a_host_share_the_models_that_its_trainer_puts_into_use(two_sensors: Path) -> None:
    services = compose(two_sensors, "compute")
    classifier, trainer = services["som_classifier"], services["model_trainer"]
    assert classifier["environment"]["ACTUM_MODEL"] == trainer["environment"]["ACTUM_MODEL"]
    assert "models:/models:ro" in classifier["volumes"]
    assert "models:/models" in trainer["volumes"]


def test_every_host_of_several_sensors_has_the_credentials_of_its_programs_and_no_others(two_sensors: Path) -> None:
    for host in ("camera1", "camera2", "compute"):
        shown = {
            Path(service["environment"]["ACTUM_CREDENTIALS"]).name
            for name, service in compose(two_sensors, host).items()
            if name != "router"
        }
        assert {each.name for each in (two_sensors / host / "credentials").iterdir()} == {"router", *shown}
        for identity in shown:
            check(two_sensors / host / "credentials" / identity)


def test_renewed_are_certificates_and_keys_and_nothing_else(written: Path) -> None:
    def contents(*names: str) -> dict[Path, bytes]:
        return {file: file.read_bytes() for file in written.rglob("*") if file.name in names}

    (written / "camera" / "settings.env").write_text("ACTUM_CAMERA=1\n")
    authority = [(written / "authority" / name).read_bytes() for name in ("ca.pem", "key.pem")]
    kept = contents("user.json5", "users.txt", "ca.pem", "settings.env", "router.json5", "compose.yml")
    renewed = contents("certificate.pem")
    write_deployment(Deployment.load(written), written, days=30)
    assert contents("user.json5", "users.txt", "ca.pem", "settings.env", "router.json5", "compose.yml") == kept
    assert [(written / "authority" / name).read_bytes() for name in ("ca.pem", "key.pem")] == authority
    assert all(file.read_bytes() != before for file, before in renewed.items())


@pytest.mark.parametrize("damage", ["missing", "another's key", "no certificate"])
def test_credentials_that_cannot_be_used_are_refused_by_name(damage: str, written: Path) -> None:
    folder = written / "people" / "viewer"
    if damage == "missing":
        (folder / "key.pem").unlink()
    elif damage == "another's key":
        (folder / "key.pem").write_bytes((written / "people" / "switch" / "key.pem").read_bytes())
    else:
        (folder / "certificate.pem").write_text("nothing")
    with pytest.raises(SettingsError, match=r"credentials: .*viewer"):
        check(folder)


@pytest.mark.parametrize("secured", [True, False])
def test_but_for_security_a_router_is_the_usual_one(secured: bool, tmp_path: Path) -> None:
    write_deployment(Deployment(HOSTS, secured=secured), tmp_path, days=30)
    usual = zenoh.Config.from_file(USUAL)
    made = zenoh.Config.from_file(tmp_path / "camera" / "router.json5")
    for path in ("mode", "scouting", "transport/shared_memory", "transport/link/tx", "adminspace"):
        assert made.get_json(path) == usual.get_json(path), path


@pytest.mark.parametrize(
    ("secured", "images_cross", "said"),
    [
        (True, False, "Images do not leave the camera's host."),
        (True, True, "Images go from host to host."),
        (False, False, "Images go from host to host."),
    ],
)
def test_a_hosts_readme_says_whether_images_cross_and_without_access_control_they_do(
    secured: bool, images_cross: bool, said: str, tmp_path: Path
) -> None:
    write_deployment(Deployment(HOSTS, secured=secured, images_cross=images_cross), tmp_path, days=30)
    assert said in (tmp_path / "camera" / "README.md").read_text()
