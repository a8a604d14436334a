"""Progress is shown where no bars can be drawn, too."""

import pytest

from actum_command.commands import progress_bars
from actum_command.commands.progress_bars import Lines, bars
from live import wait_until


def test_a_line_says_what_is_done_and_how_long_it_has_taken() -> None:
    now_s = 100.0
    lines = Lines(lambda: now_s)
    assert lines.line == "starting, after 0 s"
    lines("training the maps", 3, 30)
    now_s = 107.2
    assert lines.line == "training the maps: 3 of 30, after 7 s"


def test_outside_of_a_terminal_lines_come_while_a_step_lasts(monkeypatch: pytest.MonkeyPatch) -> None:
    lines: list[str] = []
    monkeypatch.setattr(progress_bars, "LINE_S", 0.001)
    monkeypatch.setattr(progress_bars.errors, "print", lambda line, **_: lines.append(line.partition(",")[0]))
    with bars() as progress:
        progress("reading recordings", 0, 2)
        wait_until(lambda: lines.count("reading recordings: 0 of 2") > 1, "it is printed again")


def test_quick_work_prints_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with bars() as progress:
        progress("reading recordings", 1, 1)
    assert capsys.readouterr() == ("", "")
