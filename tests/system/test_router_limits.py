"""What routers of a deployment keep back of those whom they know, and what nobody is shown."""

import json
import time

import pytest
import zenoh

from actum import keys
from actum.messages import Message
from actum.runtime.session import client_config, secret_config
from actum_deployer.router_file import IMAGES_HZ
from deployments import Deployed
from empty_messages import image, skeleton
from live import PATIENCE_S, collect
from third_session import Third, passed_on

pytestmark = pytest.mark.system


def test_a_message_that_is_too_large_is_not_passed_on(deployment: Deployed, third: Third) -> None:
    with zenoh.open(secret_config(deployment.settings("preprocessor.kinect0", "compute"))) as session:
        session.put(keys.key(keys.POSTURE, "kinect0", 1), bytes(keys.POSTURE.max_bytes + 10_000))
        session.put(keys.key(keys.POSTURE, "kinect0", 2), bytes(keys.POSTURE.max_bytes))
        passed_on(session, "preprocessor.kinect0")
    third.hears(keys.key(keys.POSTURE, "kinect0", 2))


def test_a_flood_of_images_is_thinned_and_the_frames_beside_it_are_all_there(
    deployment: Deployed, third: Third
) -> None:
    with deployment.client("gateway.kinect0", "camera") as gateway:
        assert gateway.wait_for_subscriber(keys.COLOR, PATIENCE_S)
        began_s = time.monotonic()
        for number in range(500):
            gateway.put(image(number))
            gateway.put(skeleton(number))
        frames = collect(third.heard[0], Message, lambda found: len(of(found, "actum.skeleton")) >= 500)
        lasted_s = time.monotonic() - began_s
    assert 0 < len(of(frames, "actum.image")) <= 2 + lasted_s * IMAGES_HZ


def of(messages: list[Message], schema: str) -> list[Message]:
    return [message for message in messages if schema == message.SCHEMA]


def test_no_secret_is_said(deployment: Deployed) -> None:
    """Not in a configuration that a program shows, not in what processes print, not in other files."""
    passwords = [
        json.loads(file.read_text())["transport"]["auth"]["usrpwd"]["password"]
        for file in deployment.root.glob("**/user.json5")
    ]
    shown = [str(client_config(deployment.settings("viewer", "compute")))]
    shown += [running.said() for running in deployment.running]
    told = [file for file in deployment.root.rglob("*") if file.is_file() and "credentials" not in file.parts]
    shown += [file.read_text() for file in told if not {"people", "authority"} & {*file.parts}]
    assert len(set(passwords)) > 10
    assert not [text for text in shown if any(password in text for password in passwords) or "PRIVATE KEY" in text]
