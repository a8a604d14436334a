"""What the live nodes find in whole recordings when nobody tells them of any mark, beside what the marks say."""

from collections.abc import Sequence

from actum import keys
from actum.messages import AUTO, Action, Message, Posture, Segment
from actum.node import SECOND_NS, Node, Tick, replay
from actum.recording import Recording
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.recorded_segments import SegmentCollector, classifier_input
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.segmentation import DEFAULT, Segmentation
from som_classifier.spotting.spotted import SpottingOptions

LONGEST_BREAK_NS = SECOND_NS
"""Time without a usable frame after which a person counts as away (ns): longer than any lost frames."""


class NoSpotterError(ValueError):
    """A model that cannot find actions without marks; the text says what to do."""

    def __init__(self, model: Model) -> None:
        super().__init__(
            f"model {model.id} (preset {model.metadata.preset}) cannot find actions without marks; train it anew with "
            "preset pyramid, from recordings that also show what people do before, between and after actions"
        )


class Watcher:
    """A node around the classifier: keeps marks from it, and notes what it finds, who was seen, and what was marked."""

    name = "watcher"
    inputs: tuple[keys.Topic, ...] = (keys.POSTURE, keys.SEGMENT)

    def __init__(self, node: Node) -> None:
        self.counters = node.counters
        self.answers: list[tuple[Action, int]] = []
        self.stretches_ns: dict[int, list[tuple[int, int]]] = {}
        self.marked = SegmentCollector()
        self._node = node
        self._found_itself: set[str] = set()
        self._newest_ns = 0

    def handle(self, message: Message | Tick) -> list[Message]:
        """Take a posture, a mark or a tick; put nothing."""
        self.marked.handle(message)
        if isinstance(message, Posture):
            self._see(message)
        if not isinstance(message, Segment):
            for answer in self._node.handle(message):
                self._note(answer)
        return []

    def _see(self, posture: Posture) -> None:
        self._newest_ns = posture.stamp_ns
        if not posture.valid:
            return
        stretches_ns = self.stretches_ns.setdefault(posture.agent, [])
        start_ns, end_ns = stretches_ns[-1] if stretches_ns else (posture.stamp_ns, posture.stamp_ns)
        if stretches_ns and 0 <= posture.stamp_ns - end_ns <= LONGEST_BREAK_NS:
            stretches_ns[-1] = start_ns, posture.stamp_ns
        else:
            stretches_ns.append((posture.stamp_ns, posture.stamp_ns))

    def _note(self, message: Message) -> None:
        if isinstance(message, Segment) and message.origin == AUTO:
            self._found_itself.add(message.segment_id)
        elif isinstance(message, Action) and message.final and message.segment_id in self._found_itself:
            self.answers.append((message, self._newest_ns))


def found_by(
    model: Model, recordings: Sequence[Recording], progress: Progress = silent, segmentation: Segmentation = DEFAULT
) -> Found:
    """Replay whole recordings without their marks through preprocessor and a classifier with these settings.

    Raises:
        NoSpotterError: the model cannot find actions without marks.
        RecordingError: a file is damaged.
    """
    if model.spotter(SpottingOptions()) is None:
        raise NoSpotterError(model)
    found = Found()
    for done, recording in enumerate(recordings):
        progress("watching", done, len(recordings))
        for sensor, file in views_of(recording):
            found += watched(SomClassifier(model, segmentation=segmentation), recording, sensor, file)
    progress("watching", len(recordings), len(recordings))
    return found


def views_of(recording: Recording) -> list[tuple[str, str]]:
    """Return each sensor whose skeletons a recording holds, and what stands for its part of it in what is found."""
    sensors = recording.sensors(keys.SKELETON)
    path = str(recording.path)
    return [(sensor, path if len(sensors) == 1 else f"{path} ({sensor})") for sensor in sensors]


def watched(node: Node, recording: Recording, sensor: str, file: str) -> Found:
    """Replay one sensor of a recording without its marks through the preprocessor and this classifier.

    An answer counts as decided at the newest posture's stamp when it came. Truths are the labelled segments; who acts
    in them is whom the mark names, else who was nearest to the camera, as the classifier finds out. `file` stands for
    the recording in all that is returned.
    """
    watcher = Watcher(node)
    for _ in replay(watcher, classifier_input(recording, sensor)):
        raise AssertionError("the watcher puts nothing")
    stretches = [
        Stretch(file, agent, *each) for agent, of_agent in sorted(watcher.stretches_ns.items()) for each in of_agent
    ]
    return Found(_detections(watcher, file), _truths(watcher, recording, file), stretches)


def _detections(watcher: Watcher, file: str) -> list[Detection]:
    return [
        Detection(file, action.agent, action.start_ns, action.end_ns, decided_ns, action.action, action.confidence)
        for action, decided_ns in watcher.answers
        if action.valid and action.action is not None and action.end_ns is not None
    ]


def _truths(watcher: Watcher, recording: Recording, file: str) -> list[Truth]:
    points_ns = recording.action_points_ns
    return [
        Truth(file, each.agent, each.start_ns, each.end_ns, each.label, points_ns.get(each.segment_id))
        for each in watcher.marked.closed
        if each.label is not None and each.start_ns < each.end_ns
    ]
