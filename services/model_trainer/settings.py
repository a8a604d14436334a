"""Settings of the trainer."""

from pathlib import Path

from pydantic import Field

from actum.settings import NodeSettings, data_folder

MODEL = "model.npz"
"""The file, in the trainer's folder, of the model that was put into use last."""


class Settings(NodeSettings):
    """The settings of the trainer, and those of every service."""

    trainer_data: Path = Field(
        default_factory=lambda: data_folder() / "teaching",
        description="the folder in which the trainer stores recorded examples, models and the results of trainings",
    )
    model: Path | None = Field(
        None,
        description=(
            "the model file that the classifier loads (.npz). Whenever a user chooses a model on the web page, the "
            "trainer overwrites this file with the chosen model. Default: model.npz in --trainer-data"
        ),
    )
    original_model: Path | None = Field(
        None,
        description=(
            "a model file to start with. The trainer copies this file to --model once, and again whenever this file "
            "changes. The trainer never writes to this file. Default: no such file"
        ),
    )
