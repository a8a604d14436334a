"""Settings of the marker tracker."""

import cv2
from pydantic import BaseModel, ConfigDict, Field, field_validator

from actum.settings import ServiceSettings


class ObjectSpec(BaseModel):
    """What carries a marker: the object's name, and its marker's side where it is not the usual one."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    size_m: float | None = Field(None, gt=0, le=10)


class Settings(ServiceSettings):
    """What the tracker can be told beside what every service can."""

    dictionary: str = Field("DICT_4X4_50", description="the markers' dictionary, by OpenCV's name")
    marker_size_m: float = Field(0.08, gt=0, le=10, description="side of a marker's black square")
    objects: dict[int, ObjectSpec] = Field(
        default_factory=dict,
        description='what carries which marker, as {"3": {"name": "cup", "size_m": 0.06}}; empty: every marker counts',
    )
    memory_s: float = Field(1.0, gt=0, le=60, description="how long a hidden object stays listed, by stamps")

    @field_validator("dictionary")
    @classmethod
    def _known(cls, name: str) -> str:
        known = sorted(entry for entry in dir(cv2.aruco) if entry.startswith("DICT_"))
        if name not in known:
            raise ValueError(f"{name!r} is no marker dictionary: use one of {', '.join(known)}")
        return name
