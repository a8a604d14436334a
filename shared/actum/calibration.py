"""A camera's calibration as a YAML file: written by `actum calibrate`, read by the services.

Only `image_size` (width, height; px), `K` (3x3, row-major; px) and `distortion` (OpenCV's order) must be there, so
that a maker's figures can be written down by hand. Without `skeleton_from_image` (4x4, row-major; m) the camera that
sees the markers is the one that sees the people.
"""

import datetime
import hashlib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError, field_validator

from actum import geometry
from actum.arrays import Array
from actum.atomic_file import write_whole
from actum.messages import Intrinsics, Transform

DISTORTION_LENGTHS = (0, 4, 5, 8, 12, 14)
"""How many coefficients OpenCV's distortion models have."""
FURTHEST_M = 1e6
"""Largest plausible coordinate of a camera (m)."""
LARGEST_BYTES = 100_000
"""At most this many bytes of a file are read: a calibration has some hundreds."""
HEADER = (
    "# A camera's calibration. The sensor gateway publishes it with each image if ACTUM_CALIBRATION names this file.\n"
)
MATRICES = {"K": 3, "skeleton_from_image": 4}
"""The fields that are written row by row, and how many columns they have."""
WIDTH = 120
"""Characters in a line of the file."""
CALIBRATION_REMEDY = "make a calibration with 'actum calibrate intrinsics'"
"""What to do about a file that cannot be used."""

YAML_ERRORS = (yaml.YAMLError, ValueError, LookupError, ArithmeticError, AttributeError, TypeError, RecursionError)
"""What PyYAML raises on an invalid file: its constructors also let other errors than YAMLError through."""

Pixels = Annotated[int, Field(gt=0, le=100_000)]
Measure = Annotated[FiniteFloat, Field(ge=0)]


class CalibrationError(ValueError):
    """A file that is no calibration, or not this camera's; the text names the file, the problem and what to do."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class IntrinsicsQuality(_Part):
    """Quality of K and distortion: standard deviations of fx, fy, cx and cy, and the share of the image covered."""

    date: datetime.date
    views: int
    rms_px: Measure
    standard_deviations_px: Annotated[list[Measure], Field(min_length=4, max_length=4)]
    coverage: Measure


class ExtrinsicsQuality(_Part):
    """Quality of skeleton_from_image: the reprojection error in both cameras, and standard deviations."""

    date: datetime.date
    pairs: int
    rms_px: Measure
    position_standard_deviation_mm: Measure
    rotation_standard_deviation_deg: Measure


class Calibration(_Part):
    """One camera's intrinsics, and its pose in the frame of the camera that sees people."""

    format: Literal["actum.calibration/1"] = "actum.calibration/1"
    image_size: tuple[Pixels, Pixels]
    K: Intrinsics
    distortion: list[FiniteFloat]
    skeleton_from_image: Transform | None = None
    intrinsics: IntrinsicsQuality | None = None
    extrinsics: ExtrinsicsQuality | None = None

    @field_validator("K")
    @classmethod
    def _pinhole(cls, numbers: list[float]) -> list[float]:
        if numbers[0] <= 0 or numbers[4] <= 0 or numbers[6:] != [0, 0, 1]:
            raise ValueError("the camera matrix must be [fx, 0, cx, 0, fy, cy, 0, 0, 1] with fx and fy above 0")
        return numbers

    @field_validator("distortion")
    @classmethod
    def _complete(cls, coefficients: list[float]) -> list[float]:
        if len(coefficients) not in DISTORTION_LENGTHS:
            allowed = " or ".join(map(str, DISTORTION_LENGTHS))
            raise ValueError(f"there are {len(coefficients)} distortion coefficients: give {allowed} coefficients")
        return coefficients

    @field_validator("skeleton_from_image")
    @classmethod
    def _rigid(cls, numbers: list[float] | None) -> list[float] | None:
        if numbers is not None and not geometry.is_rigid(geometry.from_flat(numbers), FURTHEST_M):
            raise ValueError(
                "skeleton_from_image is not a rigid transform: give a rotation and a position in metres as a 4x4 "
                "matrix, row by row"
            )
        return numbers

    @property
    def id(self) -> str:
        """The first 12 hexadecimal digits of the SHA-256 of its canonical JSON: equal content has an equal id."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:12]

    @property
    def matrix(self) -> Array:
        """K of shape (3, 3)."""
        return np.array(self.K, dtype=np.float64).reshape(3, 3)

    def image_fields(self) -> dict[str, list[float]]:
        """Return the fields of an `Image` message that describe its camera."""
        transform = self.skeleton_from_image or geometry.flat(np.eye(4))
        return {"K": self.K, "distortion": self.distortion, "skeleton_from_image": transform}

    def check_size(self, width: int, height: int, name: str) -> None:
        """Check that an image (its sides in px) has the size that was calibrated; `name` is for the error's text.

        Raises:
            CalibrationError: it has another size.
        """
        if (width, height) != self.image_size:
            expected = "x".join(map(str, self.image_size))
            raise CalibrationError(
                f"{name} is {width}x{height}, but the calibration is for {expected}: set the camera to {expected}, or "
                f"calibrate the camera at {width}x{height}"
            )

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a calibration file.

        Raises:
            CalibrationError: it cannot be read, or is no calibration.
        """
        try:
            with path.open("rb") as file:
                content = yaml.safe_load(file.read(LARGEST_BYTES))
        except OSError as error:
            raise CalibrationError(f"{path} cannot be read ({error.strerror}): {CALIBRATION_REMEDY}") from None
        except YAML_ERRORS:
            raise CalibrationError(
                f"{path} is not a calibration (the file is not YAML): {CALIBRATION_REMEDY}"
            ) from None
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            problem = error.errors()[0]
            place = ".".join(map(str, problem["loc"])) or "the file"
            raise CalibrationError(
                f"{path} is not a calibration ({place}: {problem['msg']}): {CALIBRATION_REMEDY}"
            ) from None

    def save(self, path: Path) -> None:
        """Write the calibration file, replacing an existing one."""
        write_whole(path.resolve(), (HEADER + _yaml(self.model_dump(exclude_none=True))).encode())


class _Dumper(yaml.SafeDumper):
    """Writes each list on one line, all other values in block style."""


for _kind in (list, tuple):
    _Dumper.add_representer(
        _kind, lambda dumper, value: dumper.represent_sequence("tag:yaml.org,2002:seq", value, flow_style=True)
    )


def _yaml(fields: dict[str, Any]) -> str:
    """Write fields one below the other, matrices row by row."""
    return "".join(
        f"{name}: {_rows(value, MATRICES[name])}\n" if name in MATRICES else _dumped({name: value})
        for name, value in fields.items()
    )


def _rows(numbers: list[float], columns: int) -> str:
    rows = [_dumped(numbers[start : start + columns]) for start in range(0, len(numbers), columns)]
    return "[\n" + ",\n".join(f"  {row.strip()[1:-1]}" for row in rows) + "]"


def _dumped(value: object) -> str:
    return str(yaml.dump(value, Dumper=_Dumper, default_flow_style=False, sort_keys=False, width=WIDTH))
