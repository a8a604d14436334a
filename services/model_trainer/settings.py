"""Settings of the trainer."""

from pathlib import Path

from pydantic import Field

from actum.settings import ServiceSettings, data_folder

MODEL = "model.npz"
"""The file, in the trainer's folder, of the model that was put into use last."""


class Settings(ServiceSettings):
    """The settings of the trainer, and those of every service."""

    trainer_data: Path = Field(
        default_factory=lambda: data_folder() / "teaching",
        description="the folder in which the trainer stores recorded examples, models and the results of trainings",
    )
    model: Path | None = Field(
        None,
        description=(
            "the model file that the classifier loads (.npz); the trainer copies each model that is put into use to "
            "this file. Default: model.npz in --trainer-data"
        ),
    )
    original_model: Path | None = Field(
        None,
        description=(
            "a model file to put into use. The trainer copies this file to --model when it finds the file for the "
            "first time, and again whenever the file changes, in place of the model in use; the trainer never writes "
            "to this file. Trained models stay in --trainer-data. Default: no such file"
        ),
    )
