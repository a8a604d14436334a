"""What tests of `actum up` share: the programs that it would start, where none runs."""

from pathlib import Path

import pytest

from actum_command.commands import system_commands
from actum_command.supervising import Program


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Program]:
    """The programs that would run beside the router."""
    programs: list[Program] = []
    monkeypatch.setenv("ACTUM_TRAINER_DATA", str(tmp_path / "teaching"))
    monkeypatch.setattr(system_commands, "refuse_taken", lambda _: None)
    monkeypatch.setattr(system_commands, "run", lambda _, listed, __: programs.extend(listed))
    return programs
