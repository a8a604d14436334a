"""Settings of the marker tracker."""

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, field_validator

from actum.messages import LARGEST_SIDE_PX
from actum.settings import ServiceSettings

Pixels = Annotated[int, Field(gt=0, le=LARGEST_SIDE_PX)]


class ObjectSpec(BaseModel):
    """An object that carries a marker: its name, and its marker's side in metres if that is not `marker_size_m`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: str
    size_m: float | None = Field(None, gt=0, le=10)


class Settings(ServiceSettings):
    """Settings of the marker tracker, besides those of every service."""

    scene: Path | None = Field(
        None,
        description="a YAML scene file of objects and their markers; replaces dictionary, marker-size-m and objects",
    )
    dictionary: str = Field("DICT_4X4_50", description="OpenCV's name of the marker dictionary")
    marker_size_m: float = Field(0.08, gt=0, le=10, description="side of a marker's black square (m)")
    objects: dict[int, ObjectSpec] = Field(
        default_factory=dict,
        description=(
            'the object that carries each marker, such as {"3": {"name": "cup", "size_m": 0.05}}; empty: '
            "each marker is an object of its own"
        ),
    )
    memory_s: float = Field(
        1.0, gt=0, le=60, description="time for which a hidden object is still published, by stamps (s)"
    )
    calibrated_size_px: tuple[Pixels, Pixels] | None = Field(
        None,
        description=(
            "width and height of the images that the camera was calibrated with; needed where images may have "
            "another size (px)"
        ),
    )

    @field_validator("dictionary")
    @classmethod
    def _known(cls, name: str) -> str:
        from marker_tracker.detection.families import canonical  # OpenCV's names; others read these settings without it

        canonical(name)
        return name
