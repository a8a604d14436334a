"""The lock files of the images: every package that a service needs, by version and hash."""

import tomllib
from collections.abc import Iterator, Set
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from compose_files import DEPLOY, MAIN, ROOT, services_of

LOCKS = DEPLOY / "requirements"
EXTRAS = {
    "service": set(),
    "scene_simulator": {"scene-simulator"},
    "marker_tracker": {"marker-tracker"},
    "web_dashboard": {"web-dashboard"},
    "actum_command": {"command-line"},
    "camera": {"camera"},
    "realsense": {"realsense"},
    "openni2": {"openni2"},
}
"""The extras of pyproject.toml that each lock file is for."""
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())


def pins(lock: Path) -> dict[str, tuple[str, int]]:
    """Each package's version and number of hashes."""
    entries = lock.read_text().replace("\\\n", " ").splitlines()
    named = [entry.split() for entry in entries if entry.strip()]
    return {
        canonicalize_name((parts := words[0].split("=="))[0]): (parts[1], sum("sha256:" in word for word in words))
        for words in named
    }


def needed(extras: Set[str]) -> Iterator[Requirement]:
    """What the project needs with these extras, those that they name included."""
    texts = [*PROJECT["project"]["dependencies"]]
    for extra in extras:
        texts += PROJECT["project"]["optional-dependencies"][extra]
    for requirement in map(Requirement, texts):
        if requirement.name == "actum":
            yield from needed(requirement.extras)
        else:
            yield requirement


def assert_locked(requirements: Iterator[Requirement], lock: Path) -> None:
    pinned = pins(lock)
    for requirement in requirements:
        version, _ = pinned[requirement.name]
        assert version in requirement.specifier, f"make lock: {lock.name} has {requirement.name} {version}"
    assert all(hashes for _, hashes in pinned.values())


@pytest.mark.parametrize("name", EXTRAS)
def test_what_a_service_needs_is_pinned_by_hash(name: str) -> None:
    assert_locked(needed(EXTRAS[name]), LOCKS / f"{name}.txt")


def test_what_builds_the_package_is_pinned_too() -> None:
    assert_locked(map(Requirement, PROJECT["build-system"]["requires"]), LOCKS / "build.txt")


def test_images_agree_on_versions() -> None:
    versions: dict[str, set[str]] = {}
    for name in EXTRAS:
        for package, (version, _) in pins(LOCKS / f"{name}.txt").items():
            versions.setdefault(package, set()).add(version)
    assert {package: found for package, found in versions.items() if len(found) > 1} == {}


def test_every_image_has_a_lock_and_every_lock_an_image() -> None:
    files = [MAIN, *DEPLOY.glob("compose.*.yml")]
    builds = [service.get("build") for file in files for service in services_of(file).values()]
    locks = {build["args"].get("LOCK", "service") for build in builds if build}
    assert locks == set(EXTRAS)
    assert {path.stem for path in LOCKS.glob("*.txt")} == {*EXTRAS, "build"}


def test_what_draws_nothing_has_no_opencv() -> None:
    assert not [package for package in pins(LOCKS / "actum_command.txt") if "opencv" in package]
