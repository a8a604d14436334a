"""`actum deploy` says what it has written, and what cannot be."""

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from actum_command.__main__ import app

HOSTS = ("--hosts", "camera=192.168.1.5,compute=192.168.1.6")


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, ["deploy", *map(str, arguments)])


def test_init_says_where_each_folder_goes(tmp_path: Path) -> None:
    ended = run("init", tmp_path, *HOSTS)
    assert ended.exit_code == 0
    assert f"compute: copy {tmp_path / 'compute'} to 192.168.1.6" in ended.stdout
    assert f"keep {tmp_path / 'authority'} where nobody else reads it" in ended.stdout
    assert (tmp_path / "camera" / "compose.yml").is_file()


def test_rotate_renews_what_init_has_written(tmp_path: Path) -> None:
    run("init", tmp_path, *HOSTS)
    shown = tmp_path / "camera" / "credentials" / "router" / "certificate.pem"
    before = shown.read_bytes()
    assert run("rotate", tmp_path).exit_code == 0
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


def test_what_was_revoked_is_not_forgotten_with_the_file_that_says_so(tmp_path: Path) -> None:
    run("init", tmp_path, *HOSTS)
    (tmp_path / "deployment.json").unlink()
    ended = run("init", tmp_path, *HOSTS)
    assert ended.exit_code == 1
    assert "delete authority/" in ended.stderr


@pytest.mark.parametrize("name", ["router.camera", "gateway.kinect9", "page", "viewer#1", ""])
def test_who_is_nobody_or_a_router_cannot_be_revoked(name: str, tmp_path: Path) -> None:
    run("init", tmp_path, *HOSTS)
    before = (tmp_path / "deployment.json").read_text()
    ended = run("rotate", tmp_path, "--revoke", name)
    assert ended.exit_code == 1
    assert "page.kinect0" in ended.stderr and "delete authority/" in ended.stderr
    assert (tmp_path / "deployment.json").read_text() == before


@pytest.mark.parametrize("days", ["-1", "1e12", "nan", "inf"])
def test_certificates_do_not_outlast_their_authority(days: str, tmp_path: Path) -> None:
    run("init", tmp_path, *HOSTS)
    ended = run("rotate", tmp_path, "--days", days)
    assert ended.exit_code == 2
    assert "--days" in ended.stderr


def test_without_security_there_are_no_credentials(tmp_path: Path) -> None:
    assert run("init", tmp_path, *HOSTS, "--open").exit_code == 0
    assert not list(tmp_path.rglob("*.pem"))
    assert "trusted with everything" in (tmp_path / "camera" / "README.md").read_text()
    assert "has no credentials" in run("rotate", tmp_path).stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("init", "--hosts", "camera=a"), "at least one camera… and one compute…"),
        (("init", *HOSTS, "--open", "--passwords"), "--open asks nobody for passwords"),
        (("rotate",), "holds no deployment.json"),
    ],
)
def test_what_cannot_be_done_is_refused(arguments: tuple[str, ...], said: str, tmp_path: Path) -> None:
    ended = run(*arguments, tmp_path)
    assert ended.exit_code == 1
    assert said in ended.stderr
