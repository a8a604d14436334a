"""People who act now and then, with nobody marking it, and a small model that has learned to find their actions."""

import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.messages import NONE, Posture, Segment, Skeleton
from actum.node import Counters
from actum.recorder import write_recording
from actum.recording import Recording
from actum_model_trainer.background import counterexamples
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import LabelledStream, Samples
from actum_model_trainer.training import train_to_spot
from people import FRAME_NS, STANDING, skeleton
from performers import HAND_PATHS, TINY, mark, posed
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from repeating import eased
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.pyramid_model import PyramidModel
from som_classifier.segmenter import Segmenter

SCRATCH_M = {4: np.array([0.0, -0.1, -0.1]), 5: np.array([-0.15, -0.45, -0.10])}
"""What people also do: how far the left elbow and hand go to the chin."""
Joints = NDArray[np.float64]


@dataclass(frozen=True)
class Act:
    """An action in a stream: its first and its last frame."""

    first: int
    last: int
    action: str


@dataclass(frozen=True)
class Scene:
    """A person's joints (frames, 15, 3), and what is done when."""

    joints: Joints
    acts: tuple[Act, ...]

    def skeletons(self, first_ns: int = 0, session: str = "test") -> list[Skeleton]:
        return [
            skeleton(first_ns + i * FRAME_NS, each, seq=i, session_id=session) for i, each in enumerate(self.joints)
        ]

    def marks(self) -> list[Segment]:
        return [
            mark(kind, frame * FRAME_NS, str(number), act.action if kind == "start" else None)
            for number, act in enumerate(self.acts)
            for kind, frame in (("start", act.first), ("end", act.last))
        ]


@cache
def scene(actions: tuple[str, ...] = tuple(HAND_PATHS) * 2, seed: int = 0, height: float = 1.0) -> Scene:
    """Each action takes 0.7 to 1.1 s; between two of them there is a rest or, every second time, a scratch as well."""
    rng = np.random.default_rng(seed)
    joints: list[Joints] = []
    acts: list[Act] = []
    for number, action in enumerate(actions):
        joints += _still(rng.integers(20, 35), height, rng)
        if number % 2:
            joints += _scratch(rng.integers(20, 30), height, rng) + _still(15, height, rng)
        frames = int(rng.integers(21, 33))
        acts.append(Act(len(joints), len(joints) + frames - 1, action))
        joints += [posed(action, phase, height, rng) for phase in eased(frames)]
    return Scene(np.array([*joints, *_still(30, height, rng)]), tuple(acts))


def _still(frames: int, height: float, rng: np.random.Generator) -> list[Joints]:
    return [(STANDING + rng.normal(0, 0.0005, (15, 3))) * height for _ in range(frames)]


def _scratch(frames: int, height: float, rng: np.random.Generator) -> list[Joints]:
    poses = [(STANDING + rng.normal(0, 0.0005, (15, 3))) for _ in range(frames)]
    for phase, pose in zip(eased(frames), poses, strict=True):
        for joint, way_m in SCRATCH_M.items():
            pose[joint] += phase * way_m
    return [pose * height for pose in poses]


def recorded(folder: Path, name: str, messages: Iterable[Skeleton | Segment], person: str = "1") -> Recording:
    write_recording(folder / f"{name}.mcap", messages, person=person, source="test")
    return Recording(folder / f"{name}.mcap")


@cache
def taught() -> Samples:
    """What two people of different height show: every action six times each."""
    with tempfile.TemporaryDirectory() as folder:
        scenes = [scene(tuple(HAND_PATHS) * 6, seed, height) for seed, height in ((1, 0.95), (2, 1.1))]
        recordings = [
            recorded(Path(folder), str(n), [*each.skeletons(), *each.marks()], str(n)) for n, each in enumerate(scenes)
        ]
        return samples_from(recordings)


@cache
def swings_said_to_be_none() -> tuple[LabelledStream, ...]:
    """Each swing that was taught, on its own and labelled as none of the actions."""
    named = [
        replace(stream, segments=tuple((*bounds, NONE) for *bounds, label in stream.segments if label == "swing"))
        for stream in taught().streams
    ]
    return tuple(counterexamples(named))


@cache
def spotting_model() -> PyramidModel:
    """A model that finds lift, push and swing, trained on two people."""
    model: Model = train_to_spot(taught().usable, taught().streams, TINY)
    assert isinstance(model, PyramidModel)
    return model


def postures(skeletons: Iterable[Skeleton]) -> Iterator[Posture]:
    node = PosePreprocessor(PoseSettings.defaults())
    for each in skeletons:
        yield from (message for message in node.handle(each) if isinstance(message, Posture))


def bounds_ns(acts: Sequence[Act], first_ns: int = 0) -> list[tuple[int, int, str]]:
    return [(first_ns + act.first * FRAME_NS, first_ns + act.last * FRAME_NS, act.action) for act in acts]


def familiarities(model: Model) -> dict[str, float]:
    """The mean familiarity of what somebody else does and is recognised, by action."""
    found: dict[str, list[float]] = {}
    of = scene(seed=9)
    frames = encoded_live(model, of)
    for act in of.acts:
        recognition = model.recognise(frames[act.first : act.last + 1], complete=True)
        if recognition.label == act.action:
            found.setdefault(act.action, []).append(recognition.familiarity or 0.0)
    return {action: float(np.mean(values)) for action, values in found.items()}


def encoded_live(model: Model, of: Scene, lost: frozenset[int] = frozenset()) -> list[Frame]:
    """A scene's frames as the classifier has them; some never come."""
    segmenter = Segmenter(Counters())
    segmenter.streams.use(lambda: model.encoder().encode)
    kept = [each for i, each in enumerate(of.skeletons()) if i not in lost]
    frames = (segmenter.posture(each)[0] for each in postures(kept))
    return [replace(frame) for frame in frames if frame is not None]  # the classifier's own forget their activity
