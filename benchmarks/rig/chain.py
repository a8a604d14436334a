"""The nodes of all services, one after another, without any transport."""

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings as FusionSettings
from actum.messages import Message
from actum.node import Numbering, Tick
from actum_command import processes
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings as TrackerSettings
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.model import Model
from som_classifier.node import SomClassifier


class Chain:
    """Preprocessor, marker tracker of the simulated objects, classifier and fusion."""

    def __init__(self, recogniser: Model, fusion: FusionSettings | None = None) -> None:
        specs = processes.simulated_objects()["ACTUM_OBJECTS"]
        tracker = TrackerSettings.model_validate_json(f'{{"objects": {specs}}}', strict=False)
        self._nodes = (
            PosePreprocessor(PoseSettings.defaults()),
            MarkerTracker(tracker),
            SomClassifier(recogniser),
            ActionFusion(fusion or FusionSettings()),
        )
        self._numbering = Numbering()

    def feed(self, message: Message | Tick) -> list[Message]:
        """Return the message and all that follows from it."""
        outputs = [] if isinstance(message, Tick) else [message]
        for node in self._nodes:
            inputs = tuple(topic.message for topic in node.inputs)
            arriving = [message] if isinstance(message, Tick) else [m for m in outputs if isinstance(m, inputs)]
            outputs += [self._numbering.numbered(m) for one in arriving for m in node.handle(one)]
        return outputs
