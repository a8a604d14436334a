"""Settings of the marker tracker."""

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, field_validator

from actum.messages import LARGEST_SIDE_PX
from actum.settings import SharedSettings

Pixels = Annotated[int, Field(gt=0, le=LARGEST_SIDE_PX)]


class ObjectSpec(BaseModel):
    """An object that carries a marker: its name, and its marker's side in metres if that is not `marker_size_m`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: str
    size_m: float | None = Field(None, gt=0, le=10)


class Settings(SharedSettings):
    """Settings of the marker tracker, besides those of every service."""

    scene: Path | None = Field(
        None,
        description=(
            "a YAML file that describes the objects and their markers. With this file, --dictionary and "
            "--marker-size-m are ignored, and --objects is not allowed"
        ),
    )
    dictionary: str = Field(
        "DICT_4X4_50", description="family (OpenCV dictionary) of the printed markers, such as DICT_APRILTAG_36h11"
    )
    marker_size_m: float = Field(
        0.08, gt=0, le=10, description="side length of the black square of a printed marker (m)"
    )
    objects: dict[int, ObjectSpec] = Field(
        default_factory=dict,
        description=(
            'for each marker id, the name of the object that carries the marker, such as {"3": {"name": "cup"}}. If '
            'the side length of a marker differs from --marker-size-m, add the side length in metres: {"3": {"name": '
            '"cup", "size_m": 0.05}}. Default: each marker is a separate object'
        ),
    )
    memory_s: float = Field(
        1.0,
        gt=0,
        le=60,
        description="time for which an object is still published after its marker was last seen (s)",
    )
    calibrated_size_px: tuple[Pixels, Pixels] | None = Field(
        None,
        description=(
            "width and height of the images with which the camera was calibrated (px), such as 1280,720; needed only "
            "if the camera now delivers images of another size"
        ),
    )

    @field_validator("dictionary")
    @classmethod
    def _known(cls, name: str) -> str:
        from marker_tracker.detection.families import canonical  # OpenCV's names; others read these settings without it

        canonical(name)
        return name
