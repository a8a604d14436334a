"""The classifier's pure step: postures and segment marks become partial and final actions."""

from collections.abc import Iterable, Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from actum import keys
from actum.messages import Action, Message, Posture, Segment, Tensor
from actum.node import Counters, Tick
from actum.skeletons import JOINTS
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.recognition import Recognition
from som_classifier.segmenter import Segmenter
from som_classifier.segments import ClosedSegment, OpenSegment
from som_classifier.settings import Settings
from som_classifier.watched_model import WatchedModel

POLL_TICKS = 5
"""Ticks between two checks of the model file, half a second: a new model seems to be used at once."""


class ModelSource(Protocol):
    """Where a new model may come from while the node runs."""

    def poll(self, counters: Counters) -> Model | None:
        """Return the model if it is new since the last call, else None."""
        ...


class SomClassifier:
    """Estimates the action while a segment is open, and answers it once when it closes."""

    name = "som_classifier"
    inputs = (keys.POSTURE, keys.SEGMENT)

    def __init__(
        self, model: Model | None = None, source: ModelSource | None = None, publish_maps: bool = False
    ) -> None:
        self.counters = Counters(state="running" if model else "no model")
        self._segmenter = Segmenter(self.counters)
        self._model: Model | None = None
        if model is not None:
            self._use(model)
        self._source = source
        self._publish_maps = publish_maps
        self._ticks = 0
        self._sensor = "unknown"

    @classmethod
    def configured(cls, settings: Settings) -> "SomClassifier":
        """Build the node as the settings say; the model file need not exist yet."""
        node = cls(source=WatchedModel(settings.model) if settings.model else None, publish_maps=settings.publish_maps)
        if settings.model is None:
            node.counters.state = "no model: --model (ACTUM_MODEL) names none"
        node._reload()
        return node

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Take a posture, a mark or a tick; return the partial and final actions that follow from it."""
        if isinstance(message, Message):
            self._sensor = message.sensor
        match message:
            case Posture():
                return list(self._posture(message))
            case Segment():
                return [self._final(closed) for closed in self._segmenter.mark(message)]
            case Tick():
                return self._tick(message)
            case _:
                return []

    def _tick(self, tick: Tick) -> list[Message]:
        self._ticks += 1
        if self._ticks % POLL_TICKS == 0:
            self._reload()
        return [self._final(closed) for closed in self._segmenter.tick(tick)]

    def _reload(self) -> None:
        model = self._source.poll(self.counters) if self._source else None
        if model is not None:
            self._use(model)

    def _use(self, model: Model) -> None:
        self._model, self.counters.state = model, "running"
        self.counters.details["model"] = model.id
        self._segmenter.use(lambda: model.encoder().encode)

    def _posture(self, posture: Posture) -> Iterator[Action]:
        frame, closed = self._segmenter.posture(posture)
        if frame is not None:
            for segment in self._segmenter.open_at(posture.agent, posture.stamp_ns):
                yield from self._partial(segment, posture)
        for answer in closed:
            yield self._final(answer)

    def _partial(self, segment: OpenSegment, posture: Posture) -> Iterator[Action]:
        frames = self._segmenter.frames_of(segment)
        recognition = self._recognise(frames, complete=False)
        if recognition is not None and segment.start_ns is not None:
            yield Action(
                stamp_ns=posture.stamp_ns,
                sensor=posture.sensor,
                agent=posture.agent,
                segment_id=segment.segment_id,
                start_ns=segment.start_ns,
                end_ns=None,
                final=False,
                **_recognised_fields(recognition),
                frames=sum(frame.valid for frame in frames),
                missed=sum(frame.missed for frame in frames),
                hand=segment.hand,
                missing_joints=_missing(frames),
            )

    def _recognise(self, frames: list[Frame], complete: bool) -> Recognition | None:
        usable = [frame for frame in frames if frame.valid]
        if self._model is None or len(usable) < self._model.min_frames:
            return None
        return self._model.recognise(usable, complete)

    def _final(self, closed: ClosedSegment) -> Action:
        recognition = None if closed.reason else self._recognise(closed.frames, complete=True)
        reason = closed.reason or (None if recognition else self._why_not(closed))
        if reason:
            self.counters.reject("rejected_segment", f"{closed.segment_id}: {reason}")
        return Action(
            stamp_ns=closed.end_ns,
            sensor=self._sensor,
            valid=reason is None,
            reason=reason,
            agent=closed.agent,
            segment_id=closed.segment_id,
            start_ns=closed.start_ns,
            end_ns=closed.end_ns,
            final=True,
            **_recognised_fields(recognition),
            frames=sum(frame.valid for frame in closed.frames),
            missed=closed.missed,
            hand=closed.hand,
            unknown=recognition.unknown if recognition else False,
            familiarity=recognition.familiarity if recognition else None,
            missing_joints=_missing(closed.frames),
            **(self._map_fields(closed.frames) if recognition and self._publish_maps else {}),
        )

    def _map_fields(self, frames: list[Frame]) -> dict[str, Any]:
        """Return the fields that explain an answer: each map's activity, and the trajectory over the first."""
        assert self._model is not None
        usable = [frame for frame in frames if frame.valid]
        maps = {name: _tensor(activity) for name, activity in self._model.maps(usable).items()}
        return {"maps": maps, "trace": _tensor(self._model.trace(usable))}

    def _why_not(self, closed: ClosedSegment) -> str:
        if self._model is None:
            return "no model"
        frames = sum(frame.valid for frame in closed.frames)
        return f"too few frames: {frames}, at least {self._model.min_frames} are needed"


def _recognised_fields(recognition: Recognition | None) -> dict[str, Any]:
    if recognition is None:
        return {"action": None, "confidence": 0.0, "activations": {}, "part": None}
    return {
        "action": recognition.label,
        "confidence": recognition.confidence,
        "activations": recognition.activations,
        "part": recognition.part,
    }


def _missing(frames: list[Frame]) -> list[str]:
    """Name the joints that some frame lacked, in the order of `JOINTS`."""
    return [JOINTS[joint] for joint in sorted({joint for frame in frames for joint in frame.missing})]


def _tensor(array: NDArray[Any]) -> Tensor:
    little = np.ascontiguousarray(array, dtype="<f4")
    return Tensor(dtype="<f4", shape=list(little.shape), data=little.tobytes())
