"""Every node with a task it does well: what it is sent, and the part of its answers that is the task's."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from itertools import chain
from typing import Any

import cv2
import numpy as np
import pytest

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings as FusionSettings
from actum.messages import Action, Event, Image, Message, Posture, Segment
from actum.node import SECOND_NS, Node
from continued import at_this_speed
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings as TrackerSettings
from people import FRAME_NS, reaches
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from recognisers import tiny_model
from scenes import START_NS, acting_on, action
from som_classifier.node import SomClassifier
from spotters import beating

NOON_NS = 1_700_000_000 * SECOND_NS
SHORT_FRAMES = 24
BEAT_NS = 3 * SECOND_NS // 10
WARM_UP = 4
"""Messages of each stream before the task: three may be lost to a stamp that was absurd before them."""

SIDE, MARGIN = 64, 24
MARKER = 3


@dataclass(frozen=True, repr=False)
class Case:
    """A node, and messages that it answers.

    `warm_up` lets every stream begin, `task` is then answered in full; both begin at a given stamp and name their
    segment as given. `wanted` says which of the answers belong to the task. `puts` is a regular expression of the keys
    on which they come, empty for a node that puts nothing.
    """

    name: str
    build: Callable[[], Node]
    warm_up: Callable[[int, str], list[Message]]
    task: Callable[[int, str], list[Message]]
    wanted: Callable[[Message, str], bool]
    puts: str

    def __repr__(self) -> str:
        return self.name

    def messages(self, first_ns: int = NOON_NS, segment_id: str = "task") -> list[Message]:
        return list(self._messages(first_ns, segment_id))

    @lru_cache(maxsize=8)  # noqa: B019  cases live as long as the tests
    def _messages(self, first_ns: int, segment_id: str) -> tuple[Message, ...]:
        return (*self.warm_up(first_ns, segment_id), *self.task(first_ns, segment_id))

    def one_of_each(self) -> list[Message]:
        """One message of each kind that it takes."""
        return list({type(message): message for message in self.messages(NOON_NS, "one")}.values())


def later(messages: Iterable[Message], shift_ns: int) -> list[Message]:
    """Move messages in time, with all the stamps in them."""
    fields = ("stamp_ns", "start_ns", "end_ns", "previous_ns")

    def moved(message: Message) -> Message:
        stamps = {name: getattr(message, name, None) for name in fields}
        return message.model_copy(update={name: ns + shift_ns for name, ns in stamps.items() if ns is not None})

    return [moved(message) for message in messages]


@cache
def _postures() -> tuple[Posture, ...]:
    node = PosePreprocessor(PoseSettings.defaults())
    return tuple(p for frame in reaches(SHORT_FRAMES) for p in node.handle(frame) if isinstance(p, Posture))


def _skeletons(frames: slice, first_ns: int, _segment_id: str) -> list[Message]:
    unnumbered = [frame.model_copy(update={"seq": None}) for frame in reaches(SHORT_FRAMES)]
    return later(unnumbered[frames], first_ns)


def _classified(frames: slice, first_ns: int, _segment_id: str) -> list[Message]:
    return later(_postures()[frames], first_ns)


def _marked(first_ns: int, segment_id: str) -> list[Message]:
    start, end = (
        Segment(stamp_ns=frame * FRAME_NS, sensor="kinect0", kind=kind, segment_id=segment_id)
        for kind, frame in (("start", WARM_UP), ("end", SHORT_FRAMES - 1))
    )
    return later([start, *_postures()[WARM_UP:], end], first_ns)


@cache
def _photograph() -> bytes:
    """Draw a marker on white, as JPEG."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    marker = cv2.aruco.generateImageMarker(dictionary, MARKER, SIDE)
    framed = cv2.copyMakeBorder(marker, *[MARGIN] * 4, cv2.BORDER_CONSTANT, value=255)
    return bytes(cv2.imencode(".jpg", framed)[1])


def photograph(stamp_ns: int = 0, **fields: Any) -> Image:
    size = SIDE + 2 * MARGIN
    message = {
        "stamp_ns": stamp_ns,
        "sensor": "kinect0",
        "format": "jpeg",
        "width": size,
        "height": size,
        "data": _photograph(),
        "K": [100.0, 0.0, size / 2, 0.0, 100.0, size / 2, 0.0, 0.0, 1.0],
        "distortion": [],
        "skeleton_from_image": np.eye(4).ravel().tolist(),
    }
    return Image.model_validate(message | fields)


def _photographs(frames: range, first_ns: int, _segment_id: str) -> list[Message]:
    return [photograph(first_ns + i * FRAME_NS) for i in frames]


SCENE = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.25, 0.0, 0.5)})


def _scene(start_s: float, end_s: float, first_ns: int, _segment_id: str) -> list[Message]:
    postures = [posture.model_copy(update={"seq": None}) for posture in SCENE.postures(start_s, end_s)]
    interleaved = chain.from_iterable(zip(postures, SCENE.sightings(start_s, end_s), strict=True))
    return later(interleaved, first_ns - START_NS)


def _acted(first_ns: int, segment_id: str) -> list[Message]:
    acted = action("push", 0.0, 0.5, segment_id=segment_id)
    return [*_scene(0.0, 0.6, first_ns, segment_id), *later([acted], first_ns - START_NS)]


def _any(_message: Message, _segment_id: str) -> bool:
    return True


def _of_segment(message: Message, segment_id: str) -> bool:
    return isinstance(message, Action | Event) and message.segment_id == segment_id


PREPROCESSOR = Case(
    "pose_preprocessor",
    lambda: PosePreprocessor(PoseSettings.defaults()),
    partial(_skeletons, slice(WARM_UP)),
    partial(_skeletons, slice(WARM_UP, None)),
    _any,
    r"actum/kinect0/posture/\d+",
)

CLASSIFIER = Case(
    "som_classifier",
    lambda: SomClassifier(tiny_model(), publish_maps=True),
    partial(_classified, slice(WARM_UP)),
    _marked,
    _of_segment,
    r"actum/kinect0/action/\d+",
)

TRACKER = Case(
    "marker_tracker",
    lambda: MarkerTracker(TrackerSettings()),
    partial(_photographs, range(WARM_UP)),
    partial(_photographs, range(WARM_UP, WARM_UP + 3)),
    _any,
    r"actum/kinect0/objects",
)

FUSION = Case(
    "action_fusion",
    lambda: ActionFusion(FusionSettings()),
    partial(_scene, -1.0, -1.0 + WARM_UP / 30),
    _acted,
    _of_segment,
    r"actum/kinect0/(event|intent)/\d+",
)

CASES = (PREPROCESSOR, CLASSIFIER, TRACKER, FUSION)

FINDING = Case(
    "som_classifier that finds segments",
    lambda: SomClassifier(beating(tiny_model(), period_ns=BEAT_NS)),
    partial(_classified, slice(WARM_UP)),
    partial(_classified, slice(WARM_UP, None)),
    _any,
    r"actum/kinect0/(segment|action/\d+)",
)
"""A task without marks. Its segments' names tell when the stream began, so a disturbance before it changes them."""

CONTINUING = Case(
    "som_classifier that continues postures",
    lambda: SomClassifier(at_this_speed()),
    partial(_classified, slice(WARM_UP)),
    partial(_classified, slice(WARM_UP, None)),
    _any,
    r"actum/kinect0/continuation/\d+",
)
"""A task whose answers rest on smoothed postures alone, so a disturbance before it changes them."""
ALL_CASES = (*CASES, FINDING, CONTINUING)

every_node = pytest.mark.parametrize("case", CASES, ids=repr)
every_node_finding_too = pytest.mark.parametrize("case", ALL_CASES, ids=repr)
