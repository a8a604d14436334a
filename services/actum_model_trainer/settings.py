"""Settings of the trainer."""

from pathlib import Path

from pydantic import Field

from actum.settings import ServiceSettings, data_folder

MODEL = "model.npz"
"""The file, in the trainer's folder, of the model that was put into use last."""


class Settings(ServiceSettings):
    """What the trainer can be told beside what every service can."""

    trainer_data: Path = Field(
        default_factory=lambda: data_folder() / "teaching",
        description="the folder in which the trainer keeps sets, models and jobs",
    )
    model: Path | None = Field(
        None, description="the model file that the classifier watches; default: model.npz in the trainer's folder"
    )
    original_model: Path | None = Field(
        None, description="a model file that is only read: it is copied to the model in use whenever it changes"
    )
