"""`actum deploy` says what it has written, and what cannot be."""

import errno
import os
import re
import shutil
import subprocess
from datetime import timedelta
from functools import partial
from pathlib import Path

import pytest
from cryptography.x509 import load_pem_x509_certificate

from actum_deployer.certificates import new_authority, now
from actum_deployer.writing import alone
from command_lines import invoke, printed, refused

run, refusal = partial(invoke, "deploy"), partial(refused, "deploy")
HOSTS = ("--hosts", "camera=192.168.1.5,compute=192.168.1.6")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `init` writes for both hosts, to be copied: dozens of keys take long to make."""
    folder = tmp_path_factory.mktemp("written") / "lab"
    printed("deploy", "init", folder, *HOSTS)
    return folder


@pytest.fixture
def lab(written: Path, tmp_path: Path) -> Path:
    return shutil.copytree(written, tmp_path / "lab")


def test_init_says_where_each_folder_goes(tmp_path: Path) -> None:
    said = printed("deploy", "init", tmp_path, *HOSTS)
    assert f"compute: copy {tmp_path / 'compute'} to 192.168.1.6" in said
    assert f"keep {tmp_path / 'authority'} private" in said
    assert (tmp_path / "camera" / "compose.yml").is_file()


def test_rotate_renews_what_init_has_written(lab: Path) -> None:
    shown = lab / "camera" / "credentials" / "router" / "certificate.pem"
    before = shown.read_bytes()
    said = printed("deploy", "rotate", lab)
    assert "copy credentials/ and router.json5 of camera, compute, and the folders of people/" in said
    assert shown.read_bytes() != before


def test_revoked_credentials_get_another_name_and_keep_it_when_init_is_run_again(tmp_path: Path) -> None:
    run("init", tmp_path, *HOSTS, "--passwords")
    router, login = tmp_path / "camera" / "router.json5", tmp_path / "people" / "viewer" / "user.json5"
    password, others = login.read_text(), (tmp_path / "people" / "switch" / "user.json5").read_text()
    ended = run("rotate", tmp_path, "--revoke", "viewer", "--revoke", "page.kinect0")
    assert ended.exit_code == 0, ended.stderr
    assert "docker compose restart router" in ended.stdout
    assert login.read_text() != password
    assert (tmp_path / "people" / "switch" / "user.json5").read_text() == others
    for again in (("init", tmp_path, *HOSTS), ("rotate", tmp_path)):
        assert run(*again).exit_code == 0
        named = router.read_text()
        assert '"viewer#1"' in named and '"page.kinect0#1"' in named and '"switch"' in named
        assert '"viewer"' not in named and '"page.kinect0"' not in named


def test_what_was_revoked_is_not_forgotten_with_the_file_that_says_so(lab: Path) -> None:
    (lab / "deployment.json").unlink()
    assert "delete the folder authority/" in refusal("init", lab, *HOSTS)


@pytest.mark.parametrize("name", ["router.camera", "gateway.kinect9", "page", "viewer#1", ""])
def test_who_is_nobody_or_a_router_cannot_be_revoked(name: str, lab: Path) -> None:
    before = (lab / "deployment.json").read_text()
    said = refusal("rotate", lab, "--revoke", name)
    assert "page.kinect0" in said and "delete the folder authority/" in said
    assert (lab / "deployment.json").read_text() == before


@pytest.mark.parametrize("days", ["-1", "0", "1e12", "nan", "inf"])
def test_certificates_neither_have_ended_already_nor_outlast_their_authority(days: str, lab: Path) -> None:
    before = files_of(lab)
    ended = run("rotate", lab, "--days", days)
    assert ended.exit_code == 2
    assert "--days" in ended.stderr
    assert files_of(lab) == before


def test_without_security_there_are_no_credentials(tmp_path: Path) -> None:
    assert run("init", tmp_path, *HOSTS, "--open").exit_code == 0
    assert not list(tmp_path.rglob("*.pem"))
    assert "access control are disabled" in (tmp_path / "camera" / "README.md").read_text()
    assert "has no credentials" in run("rotate", tmp_path).stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("init", "--hosts", "camera=a"), "'camera=a' lacks a camera host or a compute host"),
        (("init", *HOSTS, "--open", "--passwords"), "--open and --passwords cannot be used together"),
        (
            ("init", *HOSTS, "--ros-bodies", "camera"),
            "--ros-bodies works only with --ros2, with exactly one camera host",
        ),
        (("init", *HOSTS, "--ros2", "0", "--ros-bodies", "camera", "--simulate"), "without --simulate"),
        (("init", *HOSTS, "--ros2", "0", "--ros-bodies", ""), "'' is not the name of a frame"),
        (("init", *HOSTS, "--ros2", "0", "--ros-bodies", "a\nExecStart=b"), "is not the name of a frame"),
        (("init", *HOSTS, "--ros2", "0", "--ros-bodies", 'the "camera"'), "is not the name of a frame"),
        (("rotate",), "contains no file deployment.json"),
    ],
)
def test_what_cannot_be_done_is_refused(arguments: tuple[str, ...], said: str, tmp_path: Path) -> None:
    assert said in refusal(*arguments, tmp_path)


def test_a_file_in_the_place_of_the_folder_or_above_it_is_refused_in_words(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    remedy = "solve this problem, or name another file or folder"
    for place, problem in ((tmp_path / "file", "File exists"), (tmp_path / "file/lab", "Not a directory")):
        said = " ".join(refusal("init", *HOSTS, place).split())
        assert said == f"actum: {place} cannot be used ({problem}): {remedy}"
    assert (tmp_path / "file").read_text() == "mine"


def test_a_folder_that_cannot_be_written_is_refused_in_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read_only(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    monkeypatch.setattr(Path, "mkdir", read_only)
    assert "lab cannot be used (Read-only file system): solve this problem" in refusal("init", *HOSTS, tmp_path / "lab")


def files_of(folder: Path) -> dict[Path, bytes]:
    return {file: file.read_bytes() for file in folder.rglob("*") if file.is_file() and file.stat().st_size}


def damage_authority(folder: Path, how: str) -> None:
    authority = folder / "authority"
    if how in ("no key", "nothing"):
        (authority / "key.pem").unlink()
    if how == "nothing":
        (authority / "ca.pem").unlink()
    if how == "no PEM":
        (authority / "ca.pem").write_text("junk")
    if how == "another's key":
        (authority / "key.pem").write_bytes(new_authority("another", now()).key_pem)
    if how == "ended":
        ended = new_authority("ended", now() - timedelta(days=4000))
        (authority / "key.pem").write_bytes(ended.key_pem)
        (authority / "ca.pem").write_bytes(ended.certificate_pem)


@pytest.mark.parametrize("command", [("rotate", "--revoke", "viewer"), ("init", *HOSTS, "--passwords")], ids=str)
@pytest.mark.parametrize("how", ["no key", "nothing", "no PEM", "another's key", "ended"])
def test_without_the_authority_that_signed_nothing_is_written(how: str, command: tuple[str, ...], lab: Path) -> None:
    """Only `init` makes a new one, and only where nothing of the one before is left."""
    damage_authority(lab, how)
    before = files_of(lab)
    if (how, command[0]) == ("nothing", "init"):
        printed("deploy", command[0], lab, *command[1:])
        return
    assert "the certificate authority" in refusal(command[0], lab, *command[1:])
    assert files_of(lab) == before


def test_no_certificate_outlasts_its_authority(lab: Path) -> None:
    old = new_authority("old", now() - timedelta(days=3600))
    (lab / "authority" / "key.pem").write_bytes(old.key_pem)
    (lab / "authority" / "ca.pem").write_bytes(old.certificate_pem)
    assert run("rotate", lab).exit_code == 0
    shown = load_pem_x509_certificate((lab / "people" / "viewer" / "certificate.pem").read_bytes())
    assert shown.not_valid_after_utc <= old.certificate.not_valid_after_utc
    assert f"valid until {old.certificate.not_valid_after_utc.date()}" in (lab / "camera" / "README.md").read_text()


DAMAGED = {
    "no object": "3",
    "empty": "",
    "no host": '{"hosts": []}',
    "a kind that there is not": '{"hosts": [{"name": "x", "address": "a", "port": 1, "sensors": ["k"]}]}',
    "a name of another folder": '{"hosts": [{"name": "camera/../..", "address": "a", "port": 1, "sensors": ["k"]}]}',
    "a port in words": '{"hosts": [{"name": "camera", "address": "a", "port": "x", "sensors": ["k"]}]}',
    "a sensor of another key": '{"hosts": [{"name": "camera", "address": "a", "port": 1, "sensors": ["**"]}]}',
    "revoked": '{"hosts": [{"name": "camera", "address": "a", "port": 1, "sensors": []}], "revoked": {"viewer": "x"}}',
    "unknown": '{"hosts": [{"name": "camera", "address": "a", "port": 1, "sensors": ["k"]}], "revokd": {"viewer": 1}}',
}


@pytest.mark.parametrize("command", [("rotate",), ("rotate", "--revoke", "viewer"), ("init", *HOSTS)], ids=str)
@pytest.mark.parametrize("text", DAMAGED.values(), ids=DAMAGED.keys())
def test_a_damaged_deployment_is_refused_and_nothing_is_written(
    text: str, command: tuple[str, ...], lab: Path, tmp_path: Path
) -> None:
    (lab / "deployment.json").write_text(text)
    before = files_of(tmp_path)
    assert f"{lab / 'deployment.json'} cannot be used" in refusal(command[0], lab, *command[1:])
    assert files_of(tmp_path) == before


def test_a_damaged_password_is_refused_by_name_and_nothing_is_written(tmp_path: Path) -> None:
    run("init", tmp_path, *HOSTS, "--passwords")
    login = tmp_path / "people" / "viewer" / "user.json5"
    login.write_text("{")
    before = files_of(tmp_path)
    assert str(login) in refusal("rotate", tmp_path, "--revoke", "switch")
    assert files_of(tmp_path) == before


def test_without_passwords_no_router_asks_for_earlier_ones(tmp_path: Path) -> None:
    """A router that finds a list of users lets in nobody else, and a host that is new has no passwords."""
    run("init", tmp_path, *HOSTS, "--passwords")
    run("init", tmp_path, *HOSTS)
    assert not [*tmp_path.rglob("users.txt"), *tmp_path.rglob("user.json5")]


def test_while_one_writes_a_deployment_no_other_does(lab: Path) -> None:
    """Else a revocation could be lost, and a key be another certificate's."""
    with alone(lab):
        for command in (("rotate", lab), ("init", lab, *HOSTS)):
            assert "another 'actum deploy'" in refusal(*command)
    assert run("rotate", lab).exit_code == 0


@pytest.mark.parametrize("options", [(), ("--one-router",), ("--open",)], ids=str)
def test_what_is_copied_again_leaves_the_settings_of_a_host_as_they_are(
    options: tuple[str, ...], tmp_path: Path
) -> None:
    """Does on a host what its README says: the first time, and after its settings were changed there."""
    lab, installed = tmp_path / "lab", tmp_path / "etc"
    run("init", lab, *HOSTS, *options)
    for host in ("camera", "compute"):
        page = (lab / host / "README.md").read_text()
        (installed).mkdir(exist_ok=True)
        first, later = re.findall(r"sudo (cp -r [^#\n`]+?) /etc/actum(?:`|\n| )", page)
        subprocess.run([*first.split(), str(installed / host)], cwd=lab / host, check=True)
        (installed / host / "settings.env").write_text("ACTUM_CAMERA=rtsp://mine\n")
        renewed = [lab / host / "router.json5", *(lab / host).glob("credentials/*/certificate.pem")]
        for file in filter(Path.exists, renewed):
            file.write_text("renewed")
        subprocess.run([*later.split(), str(installed / host)], cwd=lab / host, check=True)
        assert (installed / host / "settings.env").read_text() == "ACTUM_CAMERA=rtsp://mine\n"
        for file in filter(Path.exists, renewed):
            assert (installed / host / file.relative_to(lab / host)).read_text() == "renewed"
