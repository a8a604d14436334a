"""A segmenter that is fed step by step."""

from actum.messages import Action, Posture, Segment
from actum.node import SECOND_NS, TICK_NS, Counters, Tick
from people import FRAME_NS, reaches
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.segmenter import Segmenter
from som_classifier.segments import ClosedSegment


def postures(frames: int = 30, first_ns: int = 0) -> list[Posture]:
    node = PosePreprocessor(PoseSettings.defaults())
    return [p for frame in reaches(frames, first_ns) for p in node.handle(frame) if isinstance(p, Posture)]


def mark(kind: str, stamp_ns: int | None = None, segment_id: str = "a", **more: object) -> Segment:
    fields = {"sensor": "kinect0", "kind": kind, "segment_id": segment_id, "stamp_ns": stamp_ns, **more}
    return Segment.model_validate(fields)


class Run:
    """A segmenter fed step by step."""

    def __init__(self) -> None:
        self.counters = Counters()
        self.segmenter = Segmenter(self.counters)
        self.closed: list[ClosedSegment] = []
        self._now_ns = 0

    def remember(self, *answers: Action) -> "Run":
        """Begin as a process that is started in the place of one that gave these answers."""
        self.segmenter.remember(answers)
        return self

    def feed(self, *inputs: Posture | Segment) -> "Run":
        for item in inputs:
            if isinstance(item, Posture):
                self.closed += self.segmenter.posture(item)[1]
            else:
                self.closed += self.segmenter.mark(item)
        return self

    def wait(self, seconds: float) -> "Run":
        for _ in range(int(seconds * SECOND_NS / TICK_NS)):
            self._now_ns += TICK_NS
            self.closed += self.segmenter.tick(Tick(self._now_ns))
        return self

    @property
    def reasons(self) -> list[str | None]:
        return [closed.reason for closed in self.closed]


def stamps(closed: ClosedSegment) -> list[int]:
    return [frame.stamp_ns // FRAME_NS for frame in closed.frames]
