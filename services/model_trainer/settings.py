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
        description="the folder in which the trainer keeps recorded examples, models and the results of trainings",
    )
    model: Path | None = Field(
        None,
        description=(
            "the file to which the trainer copies the model in use, for the classifier to load; default: model.npz "
            "in --trainer-data"
        ),
    )
    original_model: Path | None = Field(
        None,
        description=(
            "a model file to start from. The trainer only reads it: whenever the file changes, the trainer copies it "
            "to --model, in place of the model in use. Trained models stay in --trainer-data. Default: none"
        ),
    )
