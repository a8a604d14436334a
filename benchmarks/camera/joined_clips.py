"""Clips of one person joined to one video: the actions, and what the person does between them."""

from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.messages import Segment, segment_marks
from actum.node import SECOND_NS
from actum_dataset_importer.clips import clip_files
from sensor_gateway.devices.video import pictures_of

from ..recognition.videos import FLORENCE_NAMING

FRAMES_PER_SECOND = 20
"""As the clips were recorded."""
SIZE = 640, 480
STILL_FRAMES = 12
"""For how long a clip's last picture stays, and the first of the next one before it begins: 0.6 s each."""
BACKGROUND = ("tight lace", "read watch")
"""Actions that nobody labels: what people do besides."""

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Part:
    """A clip in a joined video.

    Attributes:
        first: number of its first frame in the video.
        last: number of its last frame.
    """

    label: str
    first: int
    last: int


@dataclass(frozen=True)
class Joined:
    """A joined video, and what is where in it."""

    path: Path
    person: str
    parts: tuple[Part, ...]

    @property
    def actions(self) -> list[Part]:
        """What is to be found."""
        return [part for part in self.parts if part.label not in BACKGROUND]

    def marks(self, sensor: str) -> list[Segment]:
        """Return the labelled marks of the actions; the first frame has stamp 0."""
        named = [(f"{part.first:05d}", part) for part in self.actions]
        bounds = [segment_marks(stamp_ns(p.first), stamp_ns(p.last), sensor, name, p.label) for name, p in named]
        return list(chain.from_iterable(bounds))


def stamp_ns(frame: int) -> int:
    """Return the stamp of a frame of a joined video, whose first one has stamp 0."""
    return round(frame * SECOND_NS / FRAMES_PER_SECOND)


def joined(clips: Path, person: str, path: Path) -> Joined:
    """Join all clips of a person in an order of chance, which is the same every time; between them nobody moves."""
    named = [(*FLORENCE_NAMING.read(file), file) for file in clip_files(clips)]
    own = [(label, file) for label, whose, file in named if whose == person]
    order = np.random.default_rng(int(person)).permutation(len(own))
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), FRAMES_PER_SECOND, SIZE)
    parts, written = [], 0
    for number in order:
        label, file = own[number]
        pictures = [picture.image_bgr for picture in pictures_of(file)]
        first = written + STILL_FRAMES
        for picture in chain([pictures[0]] * STILL_FRAMES, pictures, [pictures[-1]] * STILL_FRAMES):
            writer.write(picture)
        parts.append(Part(label, first, first + len(pictures) - 1))
        written += len(pictures) + 2 * STILL_FRAMES
    writer.release()
    return Joined(path, person, tuple(parts))
