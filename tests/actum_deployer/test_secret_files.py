"""Others read nothing that is secret: from the first byte on, whatever the umask, and in place of wider files."""

import os
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from actum.atomic_file import write_whole
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.writing import write_deployment

HOSTS = hosts_of("camera=192.168.1.5,compute=192.168.1.6")
SECRETS = {"key.pem", "user.json5", "users.txt", "settings.env"}


@pytest.fixture(params=[0o000, 0o022, 0o077], ids=oct)
def umask(request: pytest.FixtureRequest) -> Iterator[int]:
    before = os.umask(request.param)
    yield request.param
    os.umask(before)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def secrets(root: Path) -> list[Path]:
    return [file for file in root.rglob("*") if file.name in SECRETS]


def write(root: Path) -> None:
    write_deployment(Deployment(HOSTS, passwords=True), root, days=30)


def test_secret_files_and_their_folders_are_their_owners(umask: int, tmp_path: Path) -> None:
    root = tmp_path / "lab"
    write(root)
    assert {file.name for file in secrets(root)} == SECRETS
    assert {mode(file) for file in secrets(root)} == {0o600}
    assert {mode(folder) for folder in (root, *root.glob("*/credentials"), *root.glob("*/credentials/*"))} == {0o700}
    assert {mode(folder) for folder in (root / "people", *root.glob("people/*"), root / "authority")} == {0o700}


def test_what_containers_and_units_have_to_read_they_can(umask: int, tmp_path: Path) -> None:
    write(tmp_path / "lab")
    for host in ("camera", "compute"):
        folder = tmp_path / "lab" / host
        assert {mode(folder / name) for name in ("router.json5", "compose.yml", "README.md")} == {0o644}
        assert mode(folder / "files") == 0o755


def test_files_and_folders_that_others_could_read_are_closed(tmp_path: Path) -> None:
    write(tmp_path)
    folders = [
        *tmp_path.glob("*/credentials"),
        *tmp_path.glob("*/credentials/*"),
        *tmp_path.glob("people/*"),
        tmp_path / "authority",
    ]
    for path in (*secrets(tmp_path), *folders):
        path.chmod(0o777)
    settings = (tmp_path / "camera" / "settings.env").read_text()
    write(tmp_path)
    assert {mode(file) for file in secrets(tmp_path)} == {0o600}
    assert {mode(folder) for folder in folders} == {0o700}
    assert (tmp_path / "camera" / "settings.env").read_text() == settings


def test_a_folder_that_was_closed_is_not_opened(tmp_path: Path) -> None:
    write(tmp_path)
    closed = [tmp_path / "camera", tmp_path / "camera" / "files"]
    for folder in closed:
        folder.chmod(0o700)
    write(tmp_path)
    assert {mode(folder) for folder in closed} == {0o700}


def test_at_no_moment_is_a_secret_readable_by_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Looks at every file and folder of the deployment just before each write ends."""
    seen: set[tuple[str, int]] = set()

    def looked_at(number: int) -> None:
        for path in tmp_path.rglob("*"):
            if path.is_dir() and path.name != "systemd" and path.parent.name in ("credentials", "people"):
                seen.add(("folder", mode(path)))
            elif path.is_file() and any(name in path.name for name in SECRETS):
                seen.add(("file", mode(path)))

    monkeypatch.setattr(os, "fsync", looked_at)
    before = os.umask(0)
    try:
        write(tmp_path)
    finally:
        os.umask(before)
    assert seen == {("folder", 0o700), ("file", 0o600)}


def test_a_file_keeps_the_mode_it_is_given(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("before")
    file.chmod(0o644)
    write_whole(file, b"after", 0o600)
    assert (file.read_bytes(), mode(file)) == (b"after", 0o600)
