"""Hosts without containers: each program has a user of its own, who reads its credentials and no others."""

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.writing import write_deployment

ROOTS = os.geteuid() == 0 and bool(shutil.which("systemd-tmpfiles") and shutil.which("systemd-sysusers"))
needs_tools = pytest.mark.skipif(not ROOTS, reason="systemd-sysusers and systemd-tmpfiles, as root, are not at hand")
needs_analyze = pytest.mark.skipif(not shutil.which("systemd-analyze"), reason="systemd-analyze is not installed")
LONG = "s" * 64


@pytest.fixture(scope="module", params=["one sensor", "two, of long names"])
def lab(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("lab")
    one = hosts_of("camera=192.168.1.5,compute=192.168.1.6")
    two = hosts_of("camera1=a,camera2=b,compute=c", f"{LONG},{LONG[:-1]}t")
    write_deployment(Deployment(one if request.param == "one sensor" else two, passwords=True), root, days=30)
    return root


def units(lab: Path) -> dict[str, str]:
    return {f"{file.parents[1].name}/{file.stem}": file.read_text() for file in lab.glob("*/systemd/*.service")}


def setting(unit: str, name: str) -> list[str]:
    return re.findall(rf"^{name}=(.*)$", unit, re.MULTILINE)


def test_no_two_programs_of_a_host_run_as_the_same_user(lab: Path) -> None:
    for host in {name.partition("/")[0] for name in units(lab)}:
        users = [setting(unit, "User") for name, unit in units(lab).items() if name.startswith(f"{host}/")]
        assert all(len(each) == 1 for each in users)
        assert len({*map(tuple, users)}) == len(users)
        declared = (lab / host / "systemd" / "sysusers.conf").read_text()
        for [user] in users:
            assert len(user) <= 31
            assert user not in ("root", "actum")
            assert f"u {user} - " in declared


def test_only_the_classifier_is_in_anothers_group_that_of_its_own_trainer(lab: Path) -> None:
    for name, unit in units(lab).items():
        groups = [group for group in setting(unit, "SupplementaryGroups") if group != "video"]
        if "som_classifier" in name:
            trainer = units(lab)[name.replace("som_classifier", "model_trainer")]
            assert groups == setting(trainer, "User")
            [model] = setting(unit, 'Environment="ACTUM_MODEL')
            [folder] = setting(trainer, "StateDirectory")
            assert model.startswith(f"/var/lib/{folder}/")
            assert setting(trainer, 'Environment="ACTUM_MODEL') == [model]
            [original] = setting(trainer, 'Environment="ACTUM_ORIGINAL_MODEL')
            assert original.startswith(f"/var/lib/{folder}/model") and original != model, "it is only read"
        else:
            assert groups == []


def test_what_a_program_keeps_lies_in_a_folder_of_its_own(lab: Path) -> None:
    for name, unit in units(lab).items():
        kept = setting(unit, 'Environment="ACTUM_STATE') + setting(unit, 'Environment="ACTUM_TRAINER_DATA')
        assert len(kept) == len(setting(unit, "StateDirectory"))
        for folder, path in zip(setting(unit, "StateDirectory"), kept, strict=True):
            assert folder == f"actum/{name.partition('/')[2].removeprefix('actum-')}"
            assert path.startswith(f"/var/lib/{folder}")


@dataclass
class Installed:
    """A host's folder, installed below another root as its README says."""

    root: Path

    def user(self, name: str) -> tuple[int, int]:
        lines = (self.root / "etc" / "passwd").read_text().splitlines()
        [(uid, gid)] = [(each.split(":")[2], each.split(":")[3]) for each in lines if each.startswith(f"{name}:")]
        return int(uid), int(gid)

    def readable(self, name: str, *files: Path) -> set[Path]:
        """Return which of these files a user can open."""
        uid, gid = self.user(name)
        opening = ["sh", "-c", 'for file; do (: < "$file") 2> /dev/null && echo "$file"; done; true', "sh", *files]
        opened = subprocess.run(
            opening, user=uid, group=gid, extra_groups=(), capture_output=True, text=True, check=True
        )
        return {Path(line) for line in opened.stdout.splitlines()}


def install(folder: Path, root: Path) -> Installed:
    etc = root / "etc"
    shutil.copytree(folder, etc / "actum")
    (etc / "actum" / "web_dashboard.env").write_text("ACTUM_PAGE_TOKEN=secret")
    for name, place in (("sysusers", "sysusers.d"), ("tmpfiles", "tmpfiles.d")):
        (etc / place).mkdir(parents=True)
        shutil.copy(folder / "systemd" / f"{name}.conf", etc / place / "actum.conf")
    hand_over(root)
    return Installed(root)


def hand_over(root: Path) -> None:
    for tool in (["systemd-sysusers"], ["systemd-tmpfiles", "--create"]):
        subprocess.run([*tool, f"--root={root}", "actum.conf"], check=True, capture_output=True)


@pytest.fixture
def other_root() -> Iterator[Path]:
    """A folder that every user may enter, unlike those of pytest."""
    with TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


@needs_tools
def test_each_user_reads_its_own_credentials_and_no_others(lab: Path, other_root: Path) -> None:
    for host in [each for each in lab.iterdir() if (each / "systemd").exists()]:
        installed = install(host, other_root / host.name)
        own = {}
        for file in host.glob("systemd/*.service"):
            unit = file.read_text()
            [user], [credentials] = setting(unit, "User"), setting(unit, 'Environment="ACTUM_CREDENTIALS')
            own[user] = Path(credentials.rstrip('"')).name
        folders = {folder.name for folder in (host / "credentials").iterdir()}
        assert {*own.values()} == folders
        etc = installed.root / "etc" / "actum"
        files = [*etc.glob("credentials/*/*"), *(etc / name for name in ("settings.env", "web_dashboard.env"))]
        assert all(file.exists() for file in files)
        for user, name in own.items():
            secrets = {*(etc / "credentials" / name).iterdir()}
            assert installed.readable(user, *files, etc / "router.json5") == {*secrets, etc / "router.json5"}, user


@needs_tools
def test_renewed_credentials_are_handed_over_as_the_first(tmp_path: Path, other_root: Path) -> None:
    root = tmp_path / "lab"
    deployment = Deployment(hosts_of("camera=192.168.1.5,compute=192.168.1.6"))
    write_deployment(deployment, root, days=30)
    installed = install(root / "compute", other_root / "compute")
    write_deployment(deployment, root, days=30)
    etc = installed.root / "etc" / "actum"
    shutil.copytree(root / "compute" / "credentials", etc / "credentials", dirs_exist_ok=True)
    hand_over(installed.root)
    key = etc / "credentials" / "fusion.kinect0" / "key.pem"
    assert installed.readable("actum-action_fusion", key) == {key}
    assert installed.readable("actum-web_dashboard", key) == set()


@needs_analyze
def test_systemd_accepts_the_units(lab: Path, tmp_path: Path) -> None:
    files = [str(file) for file in lab.glob("compute/systemd/*.service")]
    verified = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", *files],
        capture_output=True,
        text=True,
        check=False,
    )
    said = [line for line in verified.stderr.splitlines() if "actum" in line and "is not executable" not in line]
    assert said == []
