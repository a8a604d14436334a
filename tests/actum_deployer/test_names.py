"""Names of sensors and hosts, long and odd: each has its own certificate, or is refused with the reason."""

from pathlib import Path

import pytest
from cryptography import x509
from cryptography.x509.oid import NameOID
from hypothesis import given
from hypothesis import strategies as st

from actum.keys import CHUNK, InvalidKeyError
from actum.settings import SettingsError
from actum_deployer.access_control import access_control
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.roles import GATEWAY, PREPROCESSOR, ROLES, common_name, identity
from actum_deployer.writing import write_deployment

LONG = "s" * 64


def shown(folder: Path) -> str:
    certificate = x509.load_pem_x509_certificate((folder / "certificate.pem").read_bytes())
    [name] = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
    return str(name.value)


@pytest.mark.parametrize("length", [51, 52, 56, 57, 64])
def test_a_sensors_name_may_be_as_long_as_keys_admit(length: int, tmp_path: Path) -> None:
    names = ["d" * length, "d" * (length - 1) + "e"]
    hosts = hosts_of("camera1=a,camera2=b,compute=c", ",".join(names))
    deployment = Deployment(hosts)
    write_deployment(deployment, tmp_path, days=30)
    folders = [folder for folder in tmp_path.glob("*/credentials/*") if folder.name != "router"]
    assert len({shown(folder) for folder in folders}) == len(folders)
    assert len(folders) == sum(bool(sensor) for _, sensor in deployment.subjects)
    subjects = access_control(deployment)["subjects"]
    named = {name for subject in subjects for name in subject["cert_common_names"]}
    assert {shown(folder) for folder in folders} <= named


def test_many_sensors_of_long_names_have_credentials_in_folders_that_can_be_made(tmp_path: Path) -> None:
    names = [f"{number:064}" for number in range(5)]
    cameras = ",".join(f"camera{number}=a{number}" for number in range(5))
    deployment = Deployment(hosts_of(f"{cameras},compute=c", ",".join(names)))
    write_deployment(deployment, tmp_path, days=30)
    [folder] = (tmp_path / "compute" / "credentials").glob("classifier.*")
    subjects = access_control(deployment)["subjects"]
    assert shown(folder) in {name for subject in subjects for name in subject["cert_common_names"]}


def test_a_hosts_name_may_be_as_long(tmp_path: Path) -> None:
    camera = "camera" + "a" * 58
    deployment = Deployment(hosts_of(f"{camera}=a,compute=b"))
    write_deployment(deployment, tmp_path, days=30)
    assert (
        f'"{shown(tmp_path / camera / "credentials" / "router")}"'
        in (tmp_path / "compute" / "router.json5").read_text()
    )


@given(st.lists(st.tuples(st.sampled_from(ROLES), st.from_regex(CHUNK, fullmatch=True)), unique=True))
def test_no_two_have_the_same_common_name(given_: list) -> None:
    identities = {identity(role, sensor) for role, sensor in given_}
    names = {common_name(each) for each in identities}
    assert len(names) == len(identities)
    assert all(len(name) <= 64 for name in names)


def test_short_names_are_as_they_are() -> None:
    assert common_name(identity(GATEWAY, "kinect0")) == "gateway.kinect0"
    assert len(common_name(identity(PREPROCESSOR, LONG))) == 64


@pytest.mark.parametrize(
    "sensors", ["kïnect", "*", "a/b", "..", "a b", "Door", "", " ", "door,", "a\n", "$*", "x" * 65, "door,door"]
)
def test_a_sensor_that_cannot_be_is_refused(sensors: str) -> None:
    with pytest.raises((SettingsError, InvalidKeyError), match=r"sensors|is not a valid part of a key"):
        hosts_of("camera=a,compute=b", sensors)


@pytest.mark.parametrize(
    "address",
    [
        "*", "a b", "a/b", "..", "-a", "a-", "a..b", "kinect-höst", "a#b", "a?b", "a;b", "a@b", "a\nb", "l" * 64,
        "fe80::1::2", ".".join(["a" * 60] * 5), "0.0.0.0", "::", "256.1.1.1", "1.2.3", "fe80::1%eth0", "$(id)", '"',
        "224.0.0.1", "fe80::1",
    ],
)  # fmt: skip
def test_an_address_that_no_certificate_can_name_is_refused(address: str) -> None:
    with pytest.raises(SettingsError, match="hosts: "):
        hosts_of(f"camera={address},compute=b")


@pytest.mark.parametrize(
    ("camera", "compute"),
    [("a", "a"), ("a", "A"), ("a", "a:7447"), ("::1", "[0:0::1]:7447"), ("LAB.example", "lab.EXAMPLE")],
)
def test_two_hosts_at_one_place_are_refused(camera: str, compute: str) -> None:
    with pytest.raises(SettingsError, match=r"hosts: .*same address"):
        hosts_of(f"camera={camera},compute={compute}")


@pytest.mark.parametrize(
    "address", ["192.168.1.5", "lab", "a-b.lab.example", "my_host", "2001:db8::1", "127.0.0.1", "localhost"]
)
def test_every_usual_address_stands_in_the_certificate(address: str, tmp_path: Path) -> None:
    write_deployment(Deployment(hosts_of(f"camera={address},compute=c")), tmp_path, days=30)
    router = tmp_path / "camera" / "credentials" / "router" / "certificate.pem"
    names = x509.load_pem_x509_certificate(router.read_bytes()).extensions.get_extension_for_class(
        x509.SubjectAlternativeName
    )
    assert address in {str(each.value) for each in names.value}


def test_two_hosts_on_one_machine_have_ports_of_their_own() -> None:
    assert len(hosts_of("camera=127.0.0.1:7447,compute=127.0.0.1:7448")) == 2
