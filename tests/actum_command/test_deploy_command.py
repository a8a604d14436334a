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
