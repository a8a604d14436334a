"""What the live nodes find in whole recordings without their marks, and what the marks say."""

from collections.abc import Sequence

from actum import keys
from actum.messages import AUTO, Action, Message, Posture, Segment, is_action
from actum.node import Node, Tick, replay
from actum.recording import Recording
from actum_model_trainer.continuous.detections import Detection, Found, Truth
from actum_model_trainer.continuous.presence import Presence
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.recorded_segments import SegmentCollector, classifier_input
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.segmentation import DEFAULT, Segmentation
from som_classifier.spotting.spotted import SpottingOptions


class NoSpotterError(ValueError):
    """A model that cannot find actions without marks; the text says what to do."""

    def __init__(self, model: Model) -> None:
        super().__init__(
            f"model {model.id} (preset {model.metadata.preset}) cannot find actions without marks: train it again "
            "with preset pyramid, from recordings that also show background activity before, between and after "
            "the actions"
        )


class Watcher:
    """A node around the classifier: keeps marks from it, and notes what it finds, who was seen, and what was marked."""

    name = "watcher"
    inputs: tuple[keys.Topic, ...] = (keys.POSTURE, keys.SEGMENT)

    def __init__(self, node: Node, file: str) -> None:
        self.counters = node.counters
        self.answers: list[tuple[Action, int]] = []
        self.presence = Presence(file)
        self.marked = SegmentCollector()
        self._node = node
        self._found_itself: set[str] = set()
        self._newest_ns = 0

    def handle(self, message: Message | Tick) -> list[Message]:
        """Receive a posture, a mark or a tick; put nothing."""
        self.marked.handle(message)
        if isinstance(message, Posture):
            self._newest_ns = message.stamp_ns
            if message.valid:
                self.presence.see(message.agent, message.stamp_ns)
        if not isinstance(message, Segment):
            for put in self._node.handle(message):
                if isinstance(put, Segment) and put.origin == AUTO:
                    self._found_itself.add(put.segment_id)
                elif isinstance(put, Action) and put.final and put.segment_id in self._found_itself:
                    self.answers.append((put, self._newest_ns))
        return []


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
    watcher = Watcher(node, file)
    for _ in replay(watcher, classifier_input(recording, sensor)):
        raise AssertionError("the watcher puts nothing")
    detections = [
        Detection(
            file=file,
            agent=action.agent,
            start_ns=action.start_ns,
            end_ns=action.end_ns,
            decided_ns=decided_ns,
            label=action.action,
            confidence=action.confidence,
            familiarity=action.familiarity,
        )
        for action, decided_ns in watcher.answers
        if action.valid and action.action is not None and action.end_ns is not None
    ]
    points_ns = recording.action_points_ns
    truths = [
        Truth(file, each.agent, each.start_ns, each.end_ns, each.label, points_ns.get(each.segment_id))
        for each in watcher.marked.closed
        if is_action(each.label) and each.start_ns < each.end_ns
    ]
    return Found(detections, truths, watcher.presence.stretches)
