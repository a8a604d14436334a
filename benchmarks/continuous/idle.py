"""An hour of simulated people who do all kinds of everyday things and none of the actions."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.recognition.scores import table

from actum.messages import Action
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.everyday import ALL, Everyday
from som_classifier.model import Model

from .bench import Bench, number
from .sensitivity import asked_for, classifier_at
from .simulated import scene_of

PEOPLE, MINUTES = range(40, 46), 10
ASKED_PER_MIN = (None, 0.1, 0.5, 2.0)
FRAMES_PER_MIN = 30 * 60
BETWEEN = "between doings"
"""Stands for rest and the way to it."""
MOST_ALARMS = 6
"""In the hour, at the sensitivity that was chosen in training; none is aimed at."""


@dataclass(frozen=True)
class Idled:
    """What was told of a person who did nothing.

    Attributes:
        doings: what was done, by stamp (ns).
        answers: final answers, by what was asked for.
    """

    doings: Mapping[int, str]
    answers: Mapping[float | None, Sequence[Action]]

    def alarms(self, asked: float | None) -> Counter[str]:
        """Count the actions that were told, by what was done for most of each."""
        return Counter(
            Counter(what for ns, what in self.doings.items() if each.start_ns <= ns <= (each.end_ns or 0))
            .most_common(1)[0][0]
            for each in self.answers[asked]
            if each.valid
        )  # fmt: skip

    def rejected(self, asked: float | None) -> int:
        """Count the segments that were told and not answered."""
        return sum(not each.valid for each in self.answers[asked])


def idle(bench: Bench) -> Iterator[str]:
    """False alarms in all, and by kind of doing."""
    model = bench.model_of(bench.data.simulated.training)
    everybody = [watched_idling(model, person, MINUTES) for person in PEOPLE]
    frames = sum((Counter(each.doings.values()) for each in everybody), Counter())
    alarms = {asked: sum((each.alarms(asked) for each in everybody), Counter()) for asked in ASKED_PER_MIN}
    rejected = {asked: sum(each.rejected(asked) for each in everybody) for asked in ASKED_PER_MIN}
    minutes = {what: count / FRAMES_PER_MIN for what, count in frames.most_common()}
    yield f"""{len(PEOPLE)} people who neither teach nor are tested above, {MINUTES} minutes each, through the nodes, by
the model of the simulated scene, with the setting `false_alarms_per_min` at several values; without it the threshold
holds that was chosen in training. Required, where nothing is asked for: at most {MOST_ALARMS} false alarms (aimed at:
none), and at most one rejected segment a minute, which becomes an event that is not valid."""
    yield table(
        ("asked for, a minute", "false alarms", "a minute", "rejected segments"),
        (
            [asked_for(asked), str(told.total()), number(told.total() / sum(minutes.values())), str(rejected[asked])]
            for asked, told in alarms.items()
        ),
    )
    yield "By what was done for most of the false action:"
    yield table(
        ("", "minutes", *(f"asked for {asked_for(asked)}" for asked in alarms)),
        ([what, f"{of:.1f}", *(str(told[what]) for told in alarms.values())] for what, of in minutes.items()),
    )


def watched_idling(model: Model, person: int, minutes: float) -> Idled:
    """Let a person do nothing before classifiers that are asked for different rates of false alarms."""
    simulator = scene_of(person, 0, Everyday(ALL, least_s=60 * minutes))
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    classifiers = {asked: classifier_at(model, asked) for asked in ASKED_PER_MIN}
    answers: dict[float | None, list[Action]] = {asked: [] for asked in ASKED_PER_MIN}
    for messages in simulator.frames():
        for posture in (posture for message in messages for posture in preprocessor.handle(message)):
            for asked, classifier in classifiers.items():
                put = classifier.handle(posture)
                answers[asked] += [each for each in put if isinstance(each, Action) and each.final]
    doings = {
        simulator.stamp_ns(state.frame): (state.doing or BETWEEN).replace("_", " ")
        for state in simulator.scene.states()
    }  # fmt: skip
    return Idled(doings, answers)
