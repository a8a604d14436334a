"""The wheel holds everything, and works where no repository is: a fresh environment, a folder elsewhere, no paths."""

import json
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from live import PATIENCE_S, free_endpoint

ROOT = Path(__file__).parents[2]
LIBRARY, COMPILERS = "shared/actum/_compiled.abi3.so", ("cc", "gcc", "clang")
"""What the build compiles, and by which of these."""
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
OFFLINE = "connection broken by"
"""What pip says of an index that it cannot reach."""
NOT_IN_ALL = {"foxglove", "mediapipe", "openni", "pyrealsense2", "rerun"}
"""What some modules import and the extra `all` leaves out."""
IMPORT_EVERYTHING = """
import importlib, importlib.metadata, pkgutil
for name in {file.parts[0] for file in importlib.metadata.files("actum") if file.suffix == ".py"}:
    package = importlib.import_module(name)
    for module in pkgutil.walk_packages(package.__path__, f"{name}."):
        try:
            importlib.import_module(module.name)
        except ModuleNotFoundError as error:
            print(error.name)
"""
pytestmark = [pytest.mark.system, pytest.mark.timeout(300)]  # installs some thirty packages: 20 s, or as the network is


def environment(**more: str) -> dict[str, str]:
    """What a stranger's shell has: nothing of ours, no path to the sources. Offline, pip gives up soon."""
    foreign = {k: v for k, v in os.environ.items() if not k.startswith(("ACTUM_", "PYTHON", "VIRTUAL_ENV"))}
    return {**foreign, "PIP_RETRIES": "1", "OPENBLAS_NUM_THREADS": "1", **more}


def run(folder: Path, *command: str | Path, **more: str) -> str:
    """Run a command to its end, in a folder outside the repository; skip the test if it lacks a network."""
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment(**more),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    said = done.stdout + done.stderr
    if done.returncode and OFFLINE in said:
        pytest.skip("a wheel is built and installed with packages of PyPI, which cannot be reached")
    assert done.returncode == 0, said
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of the checkout, built from its source distribution."""
    folder = tmp_path_factory.mktemp("wheel")
    run(folder, sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture
def programs(wheel: Path, tmp_path: Path) -> Path:
    """The folder of the programs of an environment that holds the wheel with the extra `all`, and nothing else."""
    venv = tmp_path / "venv"
    run(tmp_path, sys.executable, "-m", "venv", "--without-pip", venv)
    folder = venv / ("Scripts" if os.name == "nt" else "bin")
    pip = [sys.executable, "-m", "pip", "--python", str(folder / "python"), "install", "--disable-pip-version-check"]
    run(tmp_path, *pip, "--quiet", "--no-compile", f"actum[all] @ {wheel.as_uri()}")
    return folder


@contextmanager
def running(folder: Path, *command: str | Path, **more: str) -> Iterator[subprocess.Popen[str]]:
    """Run a command until the block ends."""
    process = subprocess.Popen(
        command, cwd=folder, env=environment(**more), stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
    )
    try:
        yield process
    finally:
        process.terminate()
        process.communicate(timeout=PATIENCE_S)


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="git tells which files belong to the packages")
def test_it_holds_every_file_of_the_packages_and_no_other(wheel: Path) -> None:
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "shared", "services"]
    files = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    compiled = [LIBRARY] if any(map(shutil.which, COMPILERS)) else []
    ours = {file.partition("/")[2] for file in (*files, *compiled) if (ROOT / file).is_file()}
    packed = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert packed == ours
    assert "actum/py.typed" in packed


@pytest.mark.long
def test_a_stranger_installs_it_learns_and_recognises(programs: Path, wheel: Path, tmp_path: Path) -> None:
    actum, python = programs / "actum", programs / "python"
    assert run(tmp_path, actum, "--version") == f"actum {VERSION}\n"
    place = run(tmp_path, python, "-c", "import actum; print(actum.__file__)")
    assert Path(place).is_relative_to(programs.parent), place
    assert set(run(tmp_path, python, "-c", IMPORT_EVERYTHING).split()) <= NOT_IN_ALL

    assert str(wheel) in run(
        tmp_path, python, "-c", "from actum.installing import install_command; print(install_command('view'))"
    )

    run(tmp_path, actum, "simulate", "examples.mcap", "--repetitions", "2")
    run(tmp_path, actum, "train", "examples.mcap", "-o", "model.npz")
    here = {"ACTUM_CONNECT": free_endpoint()}
    with (
        running(tmp_path, actum, "up", "--model", "model.npz", "--marked", **here),
        running(tmp_path, actum, "watch", "--json", **here) as watch,
    ):
        assert watch.stdout
        event = next(message for message in map(json.loads, watch.stdout) if message["valid"])
        assert (event["schema"], bool(event["sentence"])) == ("actum.event/1", True)
        assert "all services are there, alive and of one version" in run(tmp_path, actum, "doctor", **here)
