"""Settings of the sensor gateway."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from actum.messages import Direction
from actum.settings import ServiceSettings, data_folder

SourceName = Literal["camera", "marker-camera", "realsense", "openni2", "recording"]


POSE_MODEL = "pose_landmarker_full.task"


def default_pose_model() -> Path:
    """Return the path at which `actum models fetch` stores the pose model, in the user's data folder."""
    return data_folder() / POSE_MODEL


def _text(number: object) -> object:
    return str(number) if type(number) is int else number


class Settings(ServiceSettings):
    """The gateway's settings, beside those of every service."""

    source: SourceName | None = Field(None, description="where the frames come from")
    path: Path | None = Field(
        None, description="the recording: a file, or a folder played in order; a depth camera's recording"
    )
    loop: bool = Field(False, description="files: play them again and again, a second between two rounds")
    calibration: Path | None = Field(
        None, description="a file of `actum calibrate`: where given, its camera is put with each colour image"
    )
    up_in_camera: Direction | None = Field(
        None, description="against gravity in the camera's frame, where it is tilted; see calibrate up"
    )
    camera: Annotated[str, BeforeValidator(_text)] = Field(
        "0", description="camera: a device's number or path, a URL, or a video file"
    )
    camera_size: str | None = Field(
        None,
        pattern=r"^\d{2,5}x\d{2,5}$",
        description="any camera: the image size to ask a device for, such as 1280x720",
    )
    field_of_view_deg: float = Field(
        60.0,
        gt=5,
        lt=170,
        description="camera, openni2: how much it sees along the picture's longer side, where it is not calibrated",
    )
    mirrored: bool = Field(False, description="camera: its images are mirrored, and are to be turned back")
    pose_model: Path = Field(
        default_factory=default_pose_model, description="any camera: the pose model that `actum models fetch` gets"
    )
    person_height_m: float | None = Field(
        None, gt=0.5, lt=2.5, description="any camera: how tall the person is; where given, distances rest on it"
    )
    images: bool = Field(True, description="put images; --no-images where a marker-camera beside this one does")
    people: int = Field(2, ge=1, le=4, description="any camera: how many people are looked for")
