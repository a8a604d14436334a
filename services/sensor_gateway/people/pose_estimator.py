"""Detects people's landmarks in images with MediaPipe's pose landmarker."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Any, Self

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.installing import install_command
from actum.node import SECOND_NS
from sensor_gateway.people.landmarks import Landmarks, joint_weights

MILLISECOND_NS = 1_000_000
HALF_PX = 0.5
"""Offset between MediaPipe's origin, the image's corner, and that of the intrinsics, the first pixel's centre."""

STDERR = 2
"""The file descriptor of the error stream."""
BLANK = np.zeros((64, 64, 3), np.uint8)
"""Image given to a model once it is opened: MediaPipe writes its start-up lines at the first image."""
SEARCH_NS = SECOND_NS
"""Interval of searches for further people while there is one: a search costs three times as much as tracking one."""
TOGETHER_NS = 2 * SECOND_NS
"""Time after several people were detected in which each image is searched for several: one may be hidden briefly."""
INSTALL_LIBRARIES = "install the missing libraries (on Debian and Ubuntu: apt install libegl1 libgles2)"
FETCH = "download a pose model with 'actum models fetch', or set ACTUM_POSE_MODEL to an existing pose model"


LANDMARKS: tuple[str, ...] = (
    "nose",
    "left_eye_inner", "left_eye", "left_eye_outer", "right_eye_inner", "right_eye", "right_eye_outer",
    "left_ear", "right_ear",
    "mouth_left", "mouth_right",
    "left_shoulder", "right_shoulder",
    "left_elbow", "right_elbow",
    "left_wrist", "right_wrist",
    "left_pinky", "right_pinky", "left_index", "right_index", "left_thumb", "right_thumb",
    "left_hip", "right_hip",
    "left_knee", "right_knee",
    "left_ankle", "right_ankle",
    "left_heel", "right_heel",
    "left_foot_index", "right_foot_index",
)  # fmt: skip
"""Names of the landmarks in MediaPipe's order; left and right are the actor's own."""

MEDIAPIPE_33: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "head": ("left_ear", "right_ear"),
        "neck": ("left_shoulder", "right_shoulder"),
        "torso": ("left_shoulder", "right_shoulder", "left_hip", "right_hip"),
        "left_shoulder": ("left_shoulder",),
        "left_elbow": ("left_elbow",),
        "left_hand": ("left_wrist", "left_pinky", "left_index"),
        "right_shoulder": ("right_shoulder",),
        "right_elbow": ("right_elbow",),
        "right_hand": ("right_wrist", "right_pinky", "right_index"),
        "left_hip": ("left_hip",),
        "left_knee": ("left_knee",),
        "left_foot": ("left_ankle", "left_foot_index"),
        "right_hip": ("right_hip",),
        "right_knee": ("right_knee",),
        "right_foot": ("right_ankle", "right_foot_index"),
    }
)
"""The landmarks whose mean is each joint: as with NiTE, the head's and the palms' joints are their centres."""

MEDIAPIPE_WEIGHTS = joint_weights(LANDMARKS, MEDIAPIPE_33)
"""The share of each landmark in each joint (15, 33)."""


class PoseModelError(ValueError):
    """There is no usable pose model; the message names the problem and the remedy."""


class PoseEstimator:
    """Detects up to `people` persons in each image of a stream; the model tracks them from image to image.

    Searching for several persons costs three times as much as tracking one, and the model smooths only a single person.
    So while there is one person, further ones are searched for once a second.

    Raises:
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
    """

    def __init__(self, model_path: Path, people: int = 2) -> None:
        if not model_path.is_file():
            raise PoseModelError(f"there is no pose model at {model_path}: {FETCH}")
        self._one = Landmarker(model_path, 1)
        self._several = Landmarker(model_path, people) if people > 1 else None
        self._together_ns: int | None = None
        self._searched_ns: int | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._one.close()
        if self._several is not None:
            self._several.close()

    def people(self, image_bgr: NDArray[np.uint8], stamp_ns: int) -> list[Landmarks]:
        """Return the landmarks of the people detected in an image (height, width, 3; BGR), in arbitrary order.

        Stamps rise; the model gets them in whole milliseconds, at least one after the last.
        """
        if self._several is not None and (
            self._sees_several(stamp_ns) or not within(self._searched_ns, stamp_ns, SEARCH_NS)
        ):
            self._searched_ns = stamp_ns
            detections = self._several.people(image_bgr, stamp_ns)
            if len(detections) > 1:
                self._together_ns = stamp_ns
            if self._sees_several(stamp_ns):
                return detections
        return self._one.people(image_bgr, stamp_ns)

    def _sees_several(self, stamp_ns: int) -> bool:
        return within(self._together_ns, stamp_ns, TOGETHER_NS)


def within(past_ns: int | None, stamp_ns: int, span_ns: int) -> bool:
    """Return whether a past stamp is less than `span_ns` before another."""
    return past_ns is not None and 0 <= stamp_ns - past_ns < span_ns


class Landmarker:
    """MediaPipe's pose landmarker: up to `people` persons in each image of a stream.

    Raises:
        PoseModelError: MediaPipe is not installed, or the file is no pose model.
    """

    def __init__(self, model_path: Path, people: int) -> None:
        self._mediapipe = _mediapipe()
        with native_stderr_dropped():
            self._landmarker = self._opened(model_path, people)
            self._landmarker.detect_for_video(self._image(BLANK), 0)
        self._last_ms = 0

    def close(self) -> None:
        """Close the model; the interpreter's end would be too late for that."""
        self._landmarker.close()

    def people(self, image_bgr: NDArray[np.uint8], stamp_ns: int) -> list[Landmarks]:
        """Return the landmarks of the people detected in an image (height, width, 3; BGR)."""
        self._last_ms = max(stamp_ns // MILLISECOND_NS, self._last_ms + 1)
        height, width = image_bgr.shape[:2]
        result = self._landmarker.detect_for_video(self._image(image_bgr), self._last_ms)
        pairs = zip(result.pose_landmarks, result.pose_world_landmarks, strict=True)
        return [
            Landmarks(
                image_px=np.array([(mark.x * width, mark.y * height) for mark in in_image]) - HALF_PX,
                world_m=np.array([(mark.x, mark.y, mark.z) for mark in in_world]),
                visibility=np.array([mark.visibility for mark in in_image]),
                joint_weights=MEDIAPIPE_WEIGHTS,
            )
            for in_image, in_world in pairs
        ]

    def _image(self, image_bgr: NDArray[np.uint8]) -> Any:
        rgb = cv2.cvtColor(image_bgr, cv2.COLOR_BGR2RGB)
        return self._mediapipe.Image(image_format=self._mediapipe.ImageFormat.SRGB, data=rgb)

    def _opened(self, model_path: Path, people: int) -> Any:
        vision = self._mediapipe.tasks.vision
        options = vision.PoseLandmarkerOptions(
            base_options=self._mediapipe.tasks.BaseOptions(model_asset_path=str(model_path)),
            running_mode=vision.RunningMode.VIDEO,
            num_poses=people,
        )
        try:
            return vision.PoseLandmarker.create_from_options(options)
        except PermissionError:
            raise PoseModelError(
                f"{model_path} cannot be read by the current user: give this user read permission"
            ) from None
        except (FileNotFoundError, RuntimeError, ValueError) as error:  # "not found": a part within the file
            first = str(error).partition("\n")[0]
            raise PoseModelError(f"{model_path} is not a pose model ({first}): {FETCH}") from None
        except OSError as error:
            raise PoseModelError(f"MediaPipe cannot be loaded ({error}): {INSTALL_LIBRARIES}") from None


@contextmanager
def native_stderr_dropped() -> Iterator[None]:
    """Drop what native code writes to the error stream: MediaPipe logs the model's start at any log level."""
    kept = os.dup(STDERR)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, STDERR)
        yield
    finally:
        os.dup2(kept, STDERR)
        os.close(kept)
        os.close(nowhere)


def _mediapipe() -> Any:
    """Import MediaPipe when it is needed: it takes a second and a hundred megabytes."""
    try:
        import mediapipe
    except ImportError as error:
        raise PoseModelError(
            f"finding people in images needs MediaPipe ({error}): run {install_command('camera')}"
        ) from None
    return mediapipe
