"""What is set in vain is told."""

import re
from importlib import import_module
from pathlib import Path

import pytest

from actum_command.misspelt import misspelt

ROOT = Path(__file__).parents[2]


SERVICES = sorted(file.parent.name for file in ROOT.glob("services/*/settings.py"))


@pytest.mark.parametrize("service", SERVICES)
def test_every_setting_of_every_service_is_known(service: str, tmp_path: Path) -> None:
    names = import_module(f"{service}.settings").Settings.model_fields
    file = tmp_path / "actum.toml"
    file.write_text("".join(f'{name} = "x"\n' for name in names))
    environment = {f"ACTUM_{name.upper()}": "x" for name in names}
    assert list(misspelt({"ACTUM_CONFIG": str(file), **environment})) == []


def test_what_resembles_a_setting_is_asked_about() -> None:
    assert list(misspelt({"ACTUM_MODLE": "m.npz"})) == ["ACTUM_MODLE is not a setting: did you mean ACTUM_MODEL?"]


def test_whatever_the_pages_and_compose_files_name_is_known() -> None:
    texts = [
        ROOT / "README.md",
        ROOT / "docker-compose.yml",
        *(ROOT / "deploy").iterdir(),
        *ROOT.glob("docs/*.md"),
    ]
    named = {name for file in texts if file.is_file() for name in re.findall("ACTUM_[A-Z_]*[A-Z]", file.read_text())}
    assert len(named) > 20
    assert list(misspelt(dict.fromkeys(named - {"ACTUM_CONFIG"}, "x"))) == []


def test_the_file_is_every_service_s_own_so_all_that_is_unknown_in_it_is_told(tmp_path: Path) -> None:
    file = tmp_path / "actum.toml"
    file.write_text('sensr = "k"\ncolour = "red"\nconnect = "tcp/a:1"\n')
    assert list(misspelt({"ACTUM_CONFIG": str(file)})) == [
        f"{file}: sensr is not a setting: did you mean sensor?",
        f"{file}: colour is not a setting",
    ]
