"""Revoked credentials are of no use to who has them, without a stop of the others; a third session tells."""

import shutil
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
import zenoh

from actum import keys
from actum.runtime import Client, NotAnsweredError, RouterUnreachableError
from actum.runtime.credentials import USERS
from actum.runtime.session import secret_config
from actum.settings import ServiceSettings
from actum_deployer.writing import write_deployment
from deployments import BARE_ROUTER, Deployed, deployed
from empty_messages import mark, skeleton
from live import PATIENCE_S, wait_until
from third_session import Third, received

pytestmark = pytest.mark.system
REFUSED_S = 1.0
"""How long who is not let in tries."""
SEGMENT = keys.key(keys.SEGMENT, "kinect0")


@pytest.fixture(params=[False, True], ids=["certificates", "passwords"])
def running(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Deployed]:
    with deployed(tmp_path, BARE_ROUTER, passwords=request.param) as made:
        yield made


def stolen(running: Deployed, identity: str) -> ServiceSettings:
    """A copy of credentials as they are now."""
    copied = running.root / f"stolen-{identity}"
    shutil.copytree(running.credentials(identity), copied)
    return running.settings(identity, "compute").model_copy(update={"credentials": copied})


def revoke(running: Deployed, *identities: str) -> None:
    """Do as `actum deploy rotate --revoke`, and wait until each router has its new file and certificate."""
    routers = [each for each in running.running if each.log.name.startswith("router")]
    before = [each.said().count("listens on") for each in routers]
    running.deployment = running.deployment.revoking(identities)
    write_deployment(running.deployment, running.root, days=30)
    anew = "every router listens anew"
    wait_until(lambda: all(each.said().count("listens on") > n for each, n in zip(routers, before, strict=True)), anew)
    assert all(each.process.poll() is None for each in routers)


def test_who_shows_a_revoked_certificate_can_do_nothing_and_the_others_go_on(running: Deployed) -> None:
    old = stolen(running, "switch")
    with running.client("viewer", "camera") as viewer:
        revoke(running, "switch")
        wait_until(viewer.connected, "who was connected is back")
        with closing(Third(running)) as third:
            if running.deployment.passwords:
                with pytest.raises(RouterUnreachableError):
                    Client(old, wait_s=REFUSED_S)
            else:
                assert_can_do_nothing(old, third)
            with running.client("switch", "compute") as switch:
                switch.put(mark("start", 1))
                third.hears(SEGMENT)


def assert_can_do_nothing(old: ServiceSettings, third: Third) -> None:
    """The router lets it in, for its authority is the right one, and passes nothing on."""
    with (
        zenoh.open(secret_config(old)) as session,
        Client(old, session=session) as client,
        Client(old, wait_s=PATIENCE_S) as listening,  # not the same: a session hears what it puts itself
    ):
        heard = listening.listen(keys.everything())
        client.put(mark("start", 1))
        session.put(SEGMENT, b"without a publisher")
        session.liveliness().declare_token(keys.alive("kinect0", "som_classifier", "mine"))
        assert third.until_told() == []
        assert third.clients[0].alive() == []
        assert client.infos() == []
        assert received(heard) == []
        with pytest.raises(NotAnsweredError):
            client.ask("pose_preprocessor", "parameters", timeout_s=REFUSED_S)


def test_a_services_are_revoked_as_peoples_are(running: Deployed) -> None:
    old = stolen(running, "gateway.kinect0")
    revoke(running, "gateway.kinect0")
    with closing(Third(running)) as third:
        came = third.heard[1]
        if not running.deployment.passwords:
            with Client(old, wait_s=PATIENCE_S) as gateway:
                gateway.put(skeleton(999))
                third.until_told()
        assert received(came) == []


def test_what_was_revoked_twice_or_by_init_again_stays_revoked(tmp_path: Path) -> None:
    with deployed(tmp_path, BARE_ROUTER) as running:
        first = stolen(running, "viewer")
        revoke(running, "viewer")
        second = running.settings("viewer", "compute")
        kept = running.root / "second"
        shutil.copytree(running.credentials("viewer"), kept)
        revoke(running, "viewer")
        revoke(running)
        with closing(Third(running)) as third:
            for old in (first, second.model_copy(update={"credentials": kept})):
                with Client(old, wait_s=PATIENCE_S) as client:
                    heard = client.listen(keys.everything())
                    third.until_told()
                    assert received(heard) == []
            with running.client("viewer", "compute") as viewer:
                heard = viewer.listen(keys.everything())
                wait_until(lambda: third.until_told() == [] and received(heard) != [], "the new one is served")


def test_a_router_goes_on_with_a_file_that_is_half_copied(tmp_path: Path) -> None:
    with deployed(tmp_path, BARE_ROUTER) as running:
        file = running.root / "compute" / "router.json5"
        whole = file.read_bytes()
        [router] = [each for each in running.running if each.log.name.startswith("router-compute")]
        file.write_bytes(whole[: len(whole) // 2])
        with running.client("viewer", "compute") as viewer:
            assert viewer.router_tells()
        assert router.said().count("listens on") == 1
        write_deployment(replace(running.deployment, images_cross=True), running.root, days=30)
        wait_until(lambda: router.said().count("listens on") == 2, "the whole file is used")
        assert router.process.poll() is None


def test_a_router_takes_up_a_list_of_users_that_is_written_after_its_certificate(tmp_path: Path) -> None:
    with deployed(tmp_path, BARE_ROUTER, passwords=True) as running:
        users = running.root / "compute" / "credentials" / "router" / USERS
        [router] = [each for each in running.running if each.log.name.startswith("router-compute")]
        with running.client("viewer", "compute"):
            users.write_text("\n".join(line for line in users.read_text().splitlines() if "viewer" not in line))
        wait_until(lambda: router.said().count("listens on") == 2, "the router listens with the other list")
        with pytest.raises(RouterUnreachableError):
            running.client("viewer", "compute", wait_s=REFUSED_S)
