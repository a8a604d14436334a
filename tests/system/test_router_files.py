"""The routers' files of two hosts, run by our router: one system, but for images."""

import pytest

from actum import keys
from actum.runtime import Client
from actum.settings import ServiceSettings
from compose_files import DEPLOY
from live import PATIENCE_S, System, free_endpoint, wait_until

SENSOR, COMPUTE = (str(DEPLOY / "zenoh" / f"{name}.json5") for name in ("router", "compute-router"))
IMAGE, SKELETON = (keys.key(topic, "kinect0") for topic in (keys.COLOR, keys.SKELETON))
pytestmark = pytest.mark.system


def test_all_but_images_is_passed_on_to_the_other_host(running: System) -> None:
    here, there = running.settings.connect, free_endpoint()
    running.start("actum_command", "router", "--config", COMPUTE, "--listen", there, "--link", here)
    running.start("actum_command", "router", "--config", SENSOR, "--listen", here)  # later: the link waits for it
    far_keys, near_keys = [], []
    with running.client() as near, Client(ServiceSettings(connect=there), wait_s=PATIENCE_S) as far:
        far.tap("actum/**", lambda sample: far_keys.append(str(sample.key_expr)))
        near.tap("actum/**", lambda sample: near_keys.append(str(sample.key_expr)))

        def both_come() -> bool:
            near.put_raw(IMAGE, b"picture")
            near.put_raw(SKELETON, b"joints")
            return far_keys.count(SKELETON) >= 5

        wait_until(both_come, "skeletons on the other host")
    assert near_keys.count(IMAGE) >= 5
    assert set(far_keys) == {SKELETON}


def test_a_link_that_is_no_endpoint_is_refused(running: System) -> None:
    refused = running.actum("router", "--listen", running.settings.connect, "--link", "elsewhere")
    assert refused.returncode == 1
    assert "'elsewhere' is not an endpoint: use tcp/host:port" in refused.stderr
