"""Routers of a deployment let in whom they know, and each may put, read and ask what its role says; a third tells."""

import json
from datetime import timedelta
from pathlib import Path

import pytest
import zenoh
from zenoh import ext

from actum import keys
from actum.messages import Message, Skeleton
from actum.runtime import Client, NotAnsweredError, RouterUnreachableError
from actum.runtime.credentials import CERTIFICATE, KEY
from actum.runtime.session import secret_config
from actum.settings import ServiceSettings
from actum_deployer.certificates import Signed, new_authority, new_certificate, now
from deployments import Deployed, deployed
from empty_messages import action, image, mark, skeleton, status
from events import event
from live import PATIENCE_S, wait_until
from scenes import acting_on
from third_session import Third, passed_on, received

pytestmark = pytest.mark.system
REFUSED_S = 1.0
"""How long who is not let in tries."""


def authority_of(deployment: Deployed) -> Signed:
    folder = deployment.root / "authority"
    return Signed.load((folder / "ca.pem").read_bytes(), (folder / "key.pem").read_bytes())


def with_other_certificate(deployment: Deployed, folder: Path, signed: Signed) -> ServiceSettings:
    """The viewer's settings, but with another certificate."""
    folder.mkdir()
    for file in deployment.credentials("viewer").iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    (folder / CERTIFICATE).write_bytes(signed.certificate_pem)
    (folder / KEY).write_bytes(signed.key_pem)
    return deployment.settings("viewer", "compute").model_copy(update={"credentials": folder})


def assert_refused(settings: ServiceSettings, third: Third) -> None:
    with pytest.raises(RouterUnreachableError), Client(settings, wait_s=REFUSED_S) as client:
        client.put(mark("start", 1))
    assert third.until_told() == []


def test_who_has_credentials_is_let_in(deployment: Deployed) -> None:
    with deployment.client("viewer", "camera") as client:
        assert client.connected()


def test_who_shows_no_certificate_is_refused(deployment: Deployed, third: Third, tmp_path: Path) -> None:
    configuration = tmp_path / "zenoh.json5"
    authority = str(deployment.root / "authority" / "ca.pem")
    configuration.write_text(json.dumps({"transport": {"link": {"tls": {"root_ca_certificate": authority}}}}))
    assert_refused(ServiceSettings(connect=deployment.endpoint("compute"), zenoh_config=configuration), third)


def test_who_speaks_without_encryption_is_refused(deployment: Deployed, third: Third) -> None:
    plain = deployment.endpoint("compute").replace("tls/", "tcp/")
    assert_refused(ServiceSettings(connect=plain), third)


def test_a_certificate_of_another_authority_is_refused(deployment: Deployed, third: Third, tmp_path: Path) -> None:
    forged = new_certificate(new_authority("another", now()), "viewer", now(), days=1)
    assert_refused(with_other_certificate(deployment, tmp_path / "forged", forged), third)


def test_an_expired_certificate_is_refused(deployment: Deployed, third: Third, tmp_path: Path) -> None:
    expired = new_certificate(authority_of(deployment), "viewer", now() - timedelta(days=9), days=8)
    assert_refused(with_other_certificate(deployment, tmp_path / "expired", expired), third)


def test_a_wrong_password_is_refused(deployment: Deployed, third: Third, tmp_path: Path) -> None:
    right = new_certificate(authority_of(deployment), "viewer", now(), days=1)
    settings = with_other_certificate(deployment, tmp_path / "wrong", right)
    assert settings.credentials is not None
    login = {"transport": {"auth": {"usrpwd": {"user": "viewer", "password": "guessed"}}}}
    (settings.credentials / "user.json5").write_text(json.dumps(login))
    assert_refused(settings, third)


def test_a_role_is_known_by_certificate_and_user_together(deployment: Deployed, third: Third, tmp_path: Path) -> None:
    switch = with_other_certificate(
        deployment, tmp_path / "mixed", new_certificate(authority_of(deployment), "switch", now(), days=1)
    )
    with zenoh.open(secret_config(switch)) as session:
        session.put(keys.key(keys.SEGMENT, "kinect0"), b"a mark")
        session.put(keys.key(keys.EVENT, "kinect0", 1), b"an event")
    assert third.until_told() == []


def test_a_router_of_another_authority_is_not_believed(deployment: Deployed, third: Third, tmp_path: Path) -> None:
    settings = deployment.settings("viewer", "compute")
    folder = tmp_path / "other"
    folder.mkdir()
    for file in deployment.credentials("viewer").iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    (folder / "ca.pem").write_bytes(new_authority("another", now()).certificate_pem)
    assert_refused(settings.model_copy(update={"credentials": folder}), third)


OTHERS_FRAME = Skeleton(stamp_ns=1, sensor="kinect1", agents=[], session_id="then")
MARK, EVENT = mark("start", 1), event("s1", "push object 1, the cup")
POSTURE = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65)).postures()[0]
DENIED: list[tuple[str, Message]] = [
    ("viewer", MARK),
    ("viewer", EVENT),
    ("viewer", action(1, 2)),
    ("viewer", status()),
    ("viewer", skeleton(1)),
    ("recorder", MARK),
    ("switch", EVENT),
    ("gateway.kinect0", OTHERS_FRAME),
    ("gateway.kinect0", MARK),
    ("gateway.kinect0", POSTURE),
    ("preprocessor.kinect0", OTHERS_FRAME),
    ("preprocessor.kinect0", action(1, 2)),
    ("tracker.kinect0", image(1)),
    ("classifier.kinect0", EVENT),
    ("fusion.kinect0", MARK),
    ("trainer.kinect0", MARK),
]
ALLOWED: list[tuple[str, Message]] = [
    ("switch", MARK),
    ("page.kinect0", MARK),
    ("classifier.kinect0", MARK),
    ("classifier.kinect0", action(1, 2)),
    ("preprocessor.kinect0", POSTURE),
    ("fusion.kinect0", EVENT),
]


def put_once(deployment: Deployed, who: str, message: Message) -> None:
    settings = deployment.settings(who, "compute")
    session = zenoh.open(secret_config(settings))
    with Client(settings, session=session) as client:
        client.put(message)
        session.put(keys.key_of(message), b"without a publisher")
        passed_on(session, who)


@pytest.mark.parametrize(("who", "message"), DENIED, ids=lambda each: getattr(each, "SCHEMA", each))
def test_who_puts_what_is_not_theirs_puts_nothing(
    who: str, message: Message, deployment: Deployed, third: Third
) -> None:
    put_once(deployment, who, message)
    assert third.until_told() == []


@pytest.mark.parametrize(("who", "message"), ALLOWED, ids=lambda each: getattr(each, "SCHEMA", each))
def test_who_puts_what_is_theirs_is_heard_on_both_hosts(
    who: str, message: Message, deployment: Deployed, third: Third
) -> None:
    put_once(deployment, who, message)
    third.hears(keys.key_of(message))


def test_a_viewer_gets_no_images_and_who_may_see_them_gets_them(deployment: Deployed, third: Third) -> None:
    """Nor does anybody on the other host: images do not cross the link."""
    key = keys.key(keys.COLOR, "kinect0")
    with deployment.client("viewer", "camera") as viewer, deployment.client("gateway.kinect0", "camera") as gateway:
        wanted = [viewer.listen(expression) for expression in (key, keys.everything())]
        assert gateway.wait_for_subscriber(keys.COLOR, PATIENCE_S)
        gateway.put(image(1))
        came = third.until_told()
        wait_until(lambda: came.extend(third.until_told()) or bool(came), "the recorder beside the camera sees it")
        assert came == [key]
        wait_until(lambda: keys.key(keys.SKELETON, "kinect0") in received(wanted[1]), "the viewer is told the rest")
        assert received(wanted[0]) == []


def test_who_comes_late_is_told_the_last_events_by_the_other_host(deployment: Deployed) -> None:
    """History goes by keys of its own, which access control knows as well."""
    settings = deployment.settings("viewer", "camera")
    with deployment.client("fusion.kinect0", "compute") as fusion, zenoh.open(secret_config(settings)) as session:
        fusion.put(EVENT)
        late = ext.declare_advanced_subscriber(
            session,
            keys.pattern(keys.EVENT, "kinect0"),
            zenoh.handlers.RingChannel(16),
            history=ext.HistoryConfig(detect_late_publishers=True, max_samples=16),
        )
        heard: list[str] = []
        wait_until(lambda: heard.extend(received_by(late)) or bool(heard), "the event that was put before")
        assert heard == [keys.key_of(EVENT)]
        late.undeclare()


def received_by(subscriber: ext.AdvancedSubscriber) -> list[str]:
    sample = subscriber.try_recv()
    return [] if sample is None else [str(sample.key_expr)]


def test_a_viewer_cannot_stand_in_for_a_service(deployment: Deployed, third: Third) -> None:
    described = keys.key(keys.INFO, "kinect0", "som_classifier")
    with zenoh.open(secret_config(deployment.settings("viewer", "compute"))) as session:
        session.liveliness().declare_token(keys.alive("kinect0", "som_classifier", "mine"))
        session.declare_queryable(described, lambda query: query.reply(described, b"it is me"))
        passed_on(session, "viewer")
        for client in third.clients:
            assert client.alive() == []
            assert client.infos() == []


def test_a_page_asks_the_services_of_its_own_sensor_and_no_others(tmp_path: Path) -> None:
    with deployed(tmp_path, sensors=("kinect0", "kinect1")) as two:
        two.start("pose_preprocessor", "compute", sensor="kinect0,kinect1")
        with two.client("switch", "compute", "kinect1") as switch:
            wait_until(lambda: len(switch.infos()) == 1, "the other sensor's service is there")
            assert switch.ask("pose_preprocessor", "parameters")
        with two.client("page.kinect0", "compute", "kinect0") as page:
            assert page.ask("pose_preprocessor", "parameters")
        with two.client("page.kinect0", "compute", "kinect1") as page:
            assert page.infos() == []
            assert page.alive() == []
            with pytest.raises(NotAnsweredError):
                page.ask("pose_preprocessor", "parameters", timeout_s=REFUSED_S)


def test_who_may_ask_services_is_answered_and_who_may_not_is_not(deployment: Deployed, third: Third) -> None:
    service = deployment.start("pose_preprocessor", "compute")
    try:
        with deployment.client("switch", "camera") as switch, deployment.client("viewer", "camera") as viewer:
            wait_until(lambda: bool(third.clients[0].infos()), "the service says what it is, on the other host")
            assert switch.ask("pose_preprocessor", "parameters")
            with pytest.raises(NotAnsweredError):
                viewer.ask("pose_preprocessor", "parameters", timeout_s=REFUSED_S)
    finally:
        service.terminate()
