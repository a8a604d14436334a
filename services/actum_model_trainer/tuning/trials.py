"""What is found in a recording with each sensitivity, all in one pass through the code that also runs live."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from actum import keys
from actum.messages import Message, Posture
from actum.node import Counters, Tick
from actum.recording import Recording
from actum_model_trainer.continuous.detections import Detection, Found
from actum_model_trainer.continuous.watching import views_of, watched
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.tuning.sensitivities import Sensitivity, sensitivities
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.segmenter import Segmenter
from som_classifier.segments import OpenSegment
from som_classifier.spotting.search import Admission, SearchPlan
from som_classifier.spotting.spotted import NOTHING, Spotted, SpottedSegment, Spotter, SpottingOptions
from som_classifier.stream import Stream

Searched = Sequence[Sequence[Detection]]
"""What was found in each stretch of a person's frames that was searched on its own, in the order of decisions."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A recording, and what is found in it with each sensitivity before a user's other options.

    Attributes:
        person: whose recording it is; empty where it says nothing.
        marked: what was done in it, and who was seen.
        searched: by sensitivity.
    """

    person: str
    marked: Found
    searched: dict[Sensitivity, Searched]

    def found(self, options: SpottingOptions) -> Found:
        """Return what the classifier publishes with these options; their sensitivity has to be one of the trial's."""
        admitted: list[Detection] = []
        for stretch in self.searched[options.false_alarms_per_min]:
            admission = Admission(options)
            admitted += [each for each in stretch if admission.admit(each.label, each.start_ns, each.end_ns) is None]
        return replace(self.marked, detections=admitted)


def tried(model: Model, recordings: Sequence[Recording], progress: Progress = silent) -> list[Trial]:
    """Watch recordings without their marks, with all sensitivities of a model at once.

    Raises:
        NoSpotterError: the model cannot find actions without marks.
        RecordingError: a file is damaged.
    """
    asked = sensitivities(model)
    trials = []
    for done, recording in enumerate(recordings):
        progress("trying sensitivities", done, len(recordings))
        for sensor, file in views_of(recording):
            searches = _Searches(model, asked, file)
            marked = watched(searches, recording, sensor, file)
            searched: dict[Sensitivity, Searched] = {
                each: [stretch[n] for stretch in searches.stretches] for n, each in enumerate(asked)
            }
            trials.append(Trial(recording.person, marked, searched))
    progress("trying sensitivities", len(recordings), len(recordings))
    return trials


class _Searches:
    """A node in the classifier's place, which searches every person's frames with several sensitivities.

    Attributes:
        stretches: for each stretch of frames, what is found in it with each sensitivity.
    """

    name = "searches"
    inputs: tuple[keys.Topic, ...] = (keys.POSTURE,)

    def __init__(self, model: Model, asked: Sequence[Sensitivity], file: str) -> None:
        self.counters = Counters()
        self.stretches: list[list[list[Detection]]] = []
        self._model, self._asked, self._file = model, asked, file
        self._segmenter = Segmenter(self.counters)
        self._segmenter.streams.use(lambda: model.encoder().encode, SearchPlan(self._next_stretch))
        self._found: list[tuple[list[Detection], SpottedSegment]] = []

    def handle(self, message: Message | Tick) -> list[Message]:
        """Receive a posture or a tick; put nothing."""
        if isinstance(message, Posture):
            frame, _ = self._segmenter.posture(message)
            stream = self._segmenter.streams.of(message.agent)
            if frame is not None and stream is not None:
                stream.search.step(frame)
                self._answer(stream, message)
        return []

    def _next_stretch(self) -> Spotter:
        spotters = self._model.spotters([SpottingOptions(false_alarms_per_min=rate) for rate in self._asked])
        self.stretches.append([[] for _ in self._asked])
        return _Several(spotters, self.stretches[-1], self._found)

    def _answer(self, stream: Stream, posture: Posture) -> None:
        """Recognise what the newest frame showed as the classifier does, before it is admitted."""
        for into, found in self._found:
            closed = stream.cut(OpenSegment("", found.start_ns, posture.agent, end_ns=found.end_ns))
            usable = [frame for frame in closed.frames if frame.valid]
            if closed.reason is None and len(usable) >= self._model.min_frames:
                answer = self._model.recognise(usable, complete=True).where_found(found.precision)
                if not (answer.unknown or answer.doubtful):
                    into.append(
                        Detection(
                            file=self._file,
                            agent=posture.agent,
                            start_ns=closed.start_ns,
                            end_ns=closed.end_ns,
                            decided_ns=posture.stamp_ns,
                            label=answer.label,
                            confidence=answer.confidence,
                            familiarity=answer.familiarity,
                        )
                    )
        self._found.clear()


class _Several(Spotter):
    """Several searches in one stream; notes what each finds, and where its answers are to be kept."""

    def __init__(
        self,
        spotters: Sequence[Spotter],
        answers: Sequence[list[Detection]],
        found: list[tuple[list[Detection], SpottedSegment]],
    ) -> None:
        self._spotters, self._answers, self._found = spotters, answers, found

    def step(self, frame: Frame) -> Spotted:
        for spotter, answers in zip(self._spotters, self._answers, strict=True):
            self._found += [(answers, segment) for segment in spotter.step(frame).segments]
        return NOTHING
