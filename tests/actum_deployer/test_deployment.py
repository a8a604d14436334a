"""Hosts and sensors as they are named, and what is dealt to whom."""

from pathlib import Path

import pytest

from actum.keys import InvalidKeyError
from actum.settings import SettingsError
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import Host, hosts_of


def test_a_camera_and_a_host_that_computes() -> None:
    assert hosts_of("camera=192.168.1.5,compute=lab.example:7500") == (
        Host("camera", "192.168.1.5", 7447, ("kinect0",)),
        Host("compute", "lab.example", 7500, ("kinect0",)),
    )


def test_several_cameras_are_dealt_to_several_that_compute() -> None:
    hosts = hosts_of("camera1=a,camera2=b,camera3=c,compute1=d,compute2=e", "door,window,desk")
    assert {host.name: host.sensors for host in hosts} == {
        "camera1": ("door",),
        "camera2": ("window",),
        "camera3": ("desk",),
        "compute1": ("door", "desk"),
        "compute2": ("window",),
    }


@pytest.mark.parametrize(
    ("written", "endpoint"),
    [
        ("[2001:db8::1]:7500", "[2001:db8::1]:7500"),
        ("2001:db8::1", "[2001:db8::1]:7447"),
        ("[2001:db8::1]", "[2001:db8::1]:7447"),
        ("host:1", "host:1"),
    ],
)
def test_addresses_of_either_protocol_have_a_port_or_the_usual_one(written: str, endpoint: str) -> None:
    camera, _ = hosts_of(f"camera={written},compute=a")
    assert camera.endpoint == endpoint


@pytest.mark.parametrize(
    ("hosts", "sensors"),
    [
        ("", None),
        ("camera=a", None),
        ("compute=a", None),
        ("camera=a,compute", None),
        ("camera=a,compute=b:0", None),
        ("camera=a,compute=b:70000", None),
        ("camera=a,compute=b:x", None),
        ("camera=a,camera=b,compute=c", None),
        ("camera=a,laptop=b,compute=c", None),
        ("Camera=a,compute=b", None),
        ("camera=a,Camera=b,compute=c", None),
        ("camera=a,compute=b,compute2=c", None),
        ("camera=a,compute=b", "door,window"),
        ("camera1=a,camera2=b,compute=c", "door,door"),
        ("camera=a,compute=b", "the door"),
    ],
)
def test_what_cannot_be_is_refused_by_name(hosts: str, sensors: str | None) -> None:
    with pytest.raises((SettingsError, InvalidKeyError), match=r"hosts|sensors|is not a valid part of a key"):
        hosts_of(hosts, sensors)


def test_a_deployment_is_read_as_it_was_saved(tmp_path: Path) -> None:
    deployment = Deployment(hosts_of("camera=a,compute=b"), passwords=True, one_router=True)
    deployment.save(tmp_path)
    assert Deployment.load(tmp_path) == deployment


@pytest.mark.parametrize("content", [None, "", "{}", '{"hosts": 1}', '{"hosts": [], "more": 1}'])
def test_what_is_no_deployment_is_refused(content: str | None, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "deployment.json").write_text(content)
    with pytest.raises(
        SettingsError,
        match=r"contains no file deployment\.json" if content is None else r"deployment\.json cannot be used",
    ):
        Deployment.load(tmp_path)
