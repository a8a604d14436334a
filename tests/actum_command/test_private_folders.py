"""Folders of what people do are made such that nobody but their owner enters them."""

import stat
from pathlib import Path

import pytest

from actum.runtime.resuming import check_state_folder
from actum.settings import RememberingSettings
from actum_command.history.event_files import EventFiles
from actum_command.history.settings import Settings as HistorySettings
from model_trainer.settings import Settings as TrainerSettings
from model_trainer.trainer import ModelTrainer


def test_what_is_taught_remembered_or_kept_is_its_owners(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taught, state, history = (tmp_path / "deep" / name for name in ("taught", "state", "history"))
    ModelTrainer.configured(TrainerSettings(trainer_data=taught))
    check_state_folder(RememberingSettings(state=state))
    [*EventFiles(history, "kinect0", HistorySettings()).recover()]
    assert {stat.S_IMODE(folder.stat().st_mode) for folder in (taught, state, history)} == {0o700}


def test_a_folder_that_is_there_already_stays_as_it_is(tmp_path: Path) -> None:
    tmp_path.chmod(0o770)
    ModelTrainer.configured(TrainerSettings(trainer_data=tmp_path))
    check_state_folder(RememberingSettings(state=tmp_path))
    assert stat.S_IMODE(tmp_path.stat().st_mode) == 0o770
