"""The files laid over the camera host's for depth cameras: what they say of the gateway."""

from importlib import import_module
from typing import Any, get_args

import pytest

from compose_files import DEPLOY, services_of

SOURCES = {"realsense": "libusb-1.0-0", "openni2": "libopenni2-0"}


def gateway(source: str) -> dict[str, Any]:
    services = services_of(DEPLOY / f"compose.{source}.yml")
    assert list(services) == ["sensor_gateway"]
    return services["sensor_gateway"]


@pytest.mark.parametrize("source", SOURCES)
def test_the_image_has_the_sources_lock_and_the_library_it_needs(source: str) -> None:
    arguments = gateway(source)["build"]["args"]

    assert arguments["LOCK"] == source
    assert SOURCES[source] in arguments["PACKAGES"].split()


@pytest.mark.parametrize("source", SOURCES)
def test_every_variable_is_a_setting_of_the_gateway_and_the_source_is_one_of_its(source: str) -> None:
    fields = import_module("sensor_gateway.settings").Settings.model_fields
    environment = gateway(source)["environment"]

    assert {name.removeprefix("ACTUM_").lower() for name in environment} <= set(fields)
    assert environment["ACTUM_SOURCE"] == source
    assert environment["ACTUM_SOURCE"] in get_args(import_module("sensor_gateway.settings").SourceName)


@pytest.mark.parametrize("source", SOURCES)
def test_usb_devices_that_come_later_can_be_used(source: str) -> None:
    service = gateway(source)

    assert "/dev/bus/usb:/dev/bus/usb" in service["volumes"]
    assert "c 189:* rmw" in service["device_cgroup_rules"]
    assert service["devices"] == []
