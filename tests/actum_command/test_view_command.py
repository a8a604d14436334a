"""`actum view` writes over nothing: what was captured live cannot be captured again."""

from pathlib import Path

import pytest

from actum_command.commands import view_command
from command_lines import invoke


def test_a_file_that_is_there_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(view_command, "refuse_without", lambda *_: None)
    captured = tmp_path / "live.rrd"
    captured.write_bytes(b"an hour of somebody's streams")
    ended = invoke("view", "-o", captured)
    assert ended.exit_code == 1
    assert f"{captured} already exists: name another file, or remove the existing file" in " ".join(
        ended.stderr.split()
    )
    assert captured.read_bytes() == b"an hour of somebody's streams"
