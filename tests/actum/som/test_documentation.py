import doctest
from pathlib import Path

import pytest

import actum.som


def test_the_examples_of_the_documentation_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    tried = doctest.testmod(actum.som)
    assert tried.attempted > 0
    assert tried.failed == 0
