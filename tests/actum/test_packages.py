"""Each package below services/ is held to its layer, and what its services reject is explained."""

import tomllib
from pathlib import Path

from actum_command.processes import SCENE
from actum_command.service_settings import SETTINGS
from actum_deployer.roles import ROLES
from collected_texts import PACKAGES

ROOT = Path(__file__).parents[2]
SERVICES = {folder.name for folder in (ROOT / "services").iterdir() if (folder / "__init__.py").is_file()}
RUNNING = {name for name in SERVICES if (ROOT / "services" / name / "settings.py").is_file()}
"""Those that are processes with settings of their own."""
LINTER = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]


def contract(name: str) -> dict[str, list[str]]:
    """Find a contract by the beginning of its name."""
    [found] = [each for each in LINTER["contracts"] if each["name"].startswith(name)]
    return found


def test_import_linter_reads_every_package() -> None:
    assert set(LINTER["root_packages"]) == SERVICES | {"actum"}


def test_every_package_has_its_layer() -> None:
    layers = contract("services stand above the library")["layers"]
    assert {name.strip() for layer in layers for name in layer.split("|")} == SERVICES | {"actum"}


def test_no_package_knows_zenoh_and_none_has_a_circle() -> None:
    assert set(contract("only the runtime knows Zenoh")["source_modules"]) >= SERVICES
    assert set(contract("no import circles")["ancestors"]) == SERVICES | {"actum"}


def test_every_service_can_be_set_by_commands_and_has_a_role_in_a_deployment() -> None:
    assert SETTINGS.keys() >= RUNNING
    assert RUNNING - {SCENE} <= {service for role in ROLES for service in role.services}


def test_what_every_service_rejects_is_searched_for() -> None:
    assert RUNNING
    assert {Path(package).parts[1] for package in PACKAGES} >= RUNNING
