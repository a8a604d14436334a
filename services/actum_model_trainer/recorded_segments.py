"""The segments of recordings, and their frames, by the nodes that also run live."""

from collections.abc import Iterable, Iterator

from actum import keys
from actum.messages import REPLAY, Message, Posture, Segment, Skeleton
from actum.node import Counters, Numbering, Tick, replay
from actum.recording import Recording
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.segmenter import Segmenter
from som_classifier.segments import ClosedSegment

STREAMS = (keys.SKELETON, keys.SEGMENT)
"""The topics that are read from a recording; postures are computed from them."""


def sensors(recording: Recording) -> list[str]:
    """Return the sensors whose segments a recording holds, sorted."""
    return sorted({mark.sensor for mark in recording.messages((keys.SEGMENT,))})


def classifier_input(
    recording: Recording, sensor: str, others: tuple[keys.Topic, ...] = ()
) -> Iterator[tuple[int, Message]]:
    """Yield each message that the live classifier of this sensor would have received, with its stamp (ns).

    Those of the topics `others` come as they were recorded.
    """
    preprocessor, numbering = PosePreprocessor(PoseSettings.defaults()), Numbering()
    for message in recording.messages((*STREAMS, *others)):
        if message.sensor == sensor:
            arriving = preprocessor.handle(message) if isinstance(message, Skeleton) else [_played(message)]
            for arrived in arriving:
                yield message.stamp_ns, numbering.numbered(arrived)


def _played(mark: Message) -> Message:
    """Return a mark as `actum play` puts it: whoever put it first, the classifier is to answer it."""
    return mark.model_copy(update={"origin": REPLAY}) if isinstance(mark, Segment) else mark


def closed_segments(messages: Iterable[tuple[int, Message]]) -> list[ClosedSegment]:
    """Return the segments of a stream of stamped (ns) messages as the classifier cuts them, in the order they end."""
    collector = SegmentCollector()
    for _ in replay(collector, messages):
        raise AssertionError("the collector puts nothing")
    return collector.closed


def why_unusable(closed: ClosedSegment) -> str | None:
    """Return the reason why no sample can be made of a segment; None where one can."""
    usable = sum(frame.valid for frame in closed.frames)
    if closed.reason is None and usable < Model.min_frames:
        return f"{usable} usable frames, at least {Model.min_frames} are needed"
    return closed.reason


class SegmentCollector:
    """A node that collects the segments that the classifier's segmenter closes."""

    name = "collector"
    inputs: tuple[keys.Topic, ...] = (keys.POSTURE, keys.SEGMENT)

    def __init__(self) -> None:
        self.counters = Counters()
        self.closed: list[ClosedSegment] = []
        self._segmenter = Segmenter(self.counters)

    def handle(self, message: Message | Tick) -> list[Message]:
        """Receive a posture, a mark or a tick; put nothing."""
        match message:
            case Posture():
                frame, closed = self._segmenter.posture(message)
                self.closed += closed
                if frame is not None:
                    self.receive(message.agent, frame)
            case Segment():
                self.closed += self._segmenter.mark(message)
            case Tick():
                self.closed += self._segmenter.tick(message)
        return []

    def receive(self, agent: int, frame: Frame) -> None:
        """Take an agent's next frame."""


class FrameCollector(SegmentCollector):
    """The same, which also keeps each person's valid frames in order, by agent."""

    def __init__(self) -> None:
        super().__init__()
        self.frames: dict[int, list[Frame]] = {}

    def receive(self, agent: int, frame: Frame) -> None:
        """Keep an agent's next frame if it is valid."""
        if frame.valid:
            self.frames.setdefault(agent, []).append(frame)
