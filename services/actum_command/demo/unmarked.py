"""The experiment without marks: people act and do everyday things in one continuous scene each, and its score."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from actum import keys
from actum.messages import Message
from actum.node import SECOND_NS
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.demo.live_test import Appearance, LiveTest
from actum_command.demo.marked import TABLE_2, TEST_SEED, objects_by_majority, paper_table, verdict
from actum_command.demo.performance import Doing, Performance
from actum_command.describing import describe_event
from actum_command.simulated_model import PAUSES
from actum_model_trainer.continuous.detections import Detection, Found, Truth
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.evaluation import wilson_interval
from scene_simulator.everyday import chosen
from scene_simulator.programme import ACTIONS, balanced_programme
from scene_simulator.simulated_scene import Scene

FIRST_UNSEEN = 101
"""The first actor of the test: people that no choice was made on, as how many teach and how often was on 1 to 9."""
LATEST_NS = 3 * SECOND_NS
"""An action that nothing was told of so long after its end (ns) is not found: deciding and fusion take less."""


def run(
    live: LiveTest, here: ServiceSettings, model: Path, actors: Sequence[int], repetitions: int
) -> list[Performance]:
    """Let one actor after the other act and do everyday things, and return what was done and told.

    Raises:
        ExperimentError: the services do not come up.
        TerminatedError: the run was asked to stop.
        RouterUnreachableError, SettingsError, UnusableError: the processes cannot run as they are set.
    """
    programs = processes.services(here, model, processes.simulated_objects(), {"segments": ["auto"]})
    programs = processes.with_page(here, programs)
    performances: list[Performance] = []
    live.run(programs, keys.SKELETON, _appearances(performances, actors, repetitions))
    return performances


def _appearances(performances: list[Performance], actors: Sequence[int], repetitions: int) -> Iterator[Appearance]:
    """Yield each actor's scene, and add what is heard of it to the performances."""
    actions = repetitions * len(ACTIONS)
    for before, actor in enumerate(actors):
        scene = {"--actor": actor, "--seed": TEST_SEED, "--repetitions": repetitions}
        continuous = {"--everyday": "all", "--minutes": 0, "--pauses": PAUSES}
        doings, longest_s = _doings(actor, repetitions)
        performance = Performance(f"person {actor}", actions, doings)
        performances.append(performance)
        witness = PersonWitness(performance, before * actions, len(actors) * actions, longest_s)
        yield Appearance(scene | continuous, witness)


def _doings(actor: int, repetitions: int) -> tuple[list[Doing], float]:
    """Return the everyday doings of the scene that the simulator plays for an actor, and how long it is (s)."""
    programme = balanced_programme(repetitions, TEST_SEED, actor)
    scene = Scene(programme, actor, TEST_SEED, everyday=chosen("all", 0, PAUSES))
    frame_ns = SECOND_NS // scene.parameters.camera.frame_rate_hz
    doings, frames = [], 0
    for kind, states in groupby(scene.states(), key=lambda state: state.doing):
        first, frames = frames, frames + sum(1 for _ in states)
        if kind is not None:
            doings.append(Doing(kind, first * frame_ns, frames * frame_ns))
    return doings, frames * frame_ns / SECOND_NS


@dataclass
class PersonWitness:
    """Hears one person's scene, says of each event what was done at that time, and of each action if it is not found.

    Attributes:
        performance: what is heard.
        before: how many actions the people before have done.
        total: how many actions all people do.
        longest_s: seconds that the scene takes.
    """

    performance: Performance
    before: int
    total: int
    longest_s: float
    _over: int = 0

    @property
    def satisfied(self) -> bool:
        """Whether the scene is over, and all of its events have come."""
        return self.performance.over

    def receive(self, message: Message) -> list[str]:
        """Receive a message; return a line for an event, and one for each action that is not found."""
        told = self.performance.receive(message)
        return [*self._not_found(), *([] if told is None else [self._line(told)])]

    def _line(self, told: Detection) -> str:
        truth = self.performance.answered().get(told)
        sentence = describe_event(self.performance.events[told])
        if truth is None:
            meanwhile = f"({background(self.performance, told)})"
            number = " " * len(self._number_of(0))
            return f"{number}  {escape(f'{meanwhile:16}')}  [red]{'false alarm':18}[/red]  {sentence}"
        action = verdict("action", told.label == truth.label)
        named = verdict("object", self.performance.object_right(told, truth))
        return f"{self._done(truth)}  {action}  {named}  {sentence}"

    def _not_found(self) -> list[str]:
        """Return a line for each action that is over for long enough now, and has no event."""
        latest_ns = self.performance.newest_ns - LATEST_NS
        over = [truth for truth in self.performance.done if truth.end_ns <= latest_ns or self.satisfied]
        newly_over, self._over = over[self._over :], len(over)
        answered = self.performance.answered().values() if newly_over else ()
        return [f"{self._done(truth)}  [red]not found[/red]" for truth in newly_over if truth not in answered]

    def _done(self, truth: Truth) -> str:
        """Return which of all actions one is, and what was done to what."""
        done = self.performance.done[truth]
        number = self._number_of(self.before + list(self.performance.done).index(truth) + 1)
        what = f'{done.action} {done.object_id} "{done.object_name}"'
        return f"{number}  {escape(what):16}"

    def _number_of(self, number: int) -> str:
        return f"{number:3}/{self.total}"


def introduction(people: int) -> str:
    """Say what is going to be seen."""
    acting = f"{people} simulated people act" if people > 1 else "One simulated person acts"
    return (
        f"{acting} in real time, with everyday things in between; the model that ships with actum has never seen them. "
        "Nobody marks when an action begins or ends.\n"
        "Each line: what was done, whether that was found and its object named, and the event."
    )


def background(performance: Performance, told: Detection) -> str:
    """Say what a person did when an action was told that was not done."""
    return (performance.doing_at(told) or "at rest").replace("_", " ")


def table(performances: Sequence[Performance]) -> Table:
    """Lay out the paper's table 2 beside this run: how often each action was done, found, and its object named."""
    counted = {action: Counter[str]() for action in TABLE_2}
    for performance in performances:
        counted_here = performance.answered()
        for truth in performance.done:
            counted[truth.label]["tests"] += 1
        for told, truth in counted_here.items():
            counted[truth.label]["actions"] += told.label == truth.label
            counted[truth.label]["objects"] += performance.object_right(told, truth)
    return paper_table({name: (each["tests"], each["actions"], each["objects"]) for name, each in counted.items()})


def summary(performances: Sequence[Performance], learned: str, people: int) -> str:
    """Return the summary of the demo's results without marks."""
    scores = scores_of(sum((performance.found for performance in performances), Found()))
    right, done = scores.event.right, scores.event.truths
    low, high = wilson_interval(right, done)
    answered = sum(len(performance.answered()) for performance in performances)
    median_s, ninth_decile_s = scores.latency_s or (float("nan"), float("nan"))
    tested = f"{people} other{'s' * (people > 1)} of other heights, tempos and handedness" if people else "one of them"
    majority = objects_by_majority(each for performance in performances for each in performance.done.values())
    return (
        f"found by itself: {right} of {done} actions (95 % interval {low:.0%} to {high:.0%}); "
        f"{answered - right} told as another action, {done - answered} not found\n"
        f"{_false_alarms(performances, scores.background_min)}\n"
        f"told {median_s:.1f} s after the end of the action (median), nine of ten within {ninth_decile_s:.1f} s\n"
        f"objects that the action alone would tell: {majority} of {done}\n"
        f"Here: learned from {learned}, tested on {tested}, who do everyday things in between; nobody marks anything. "
        "The paper: one person, a Kinect, and a switch at each start and end."
    )


def _false_alarms(performances: Sequence[Performance], background_min: float) -> str:
    kinds: Counter[str] = Counter()
    for performance in performances:
        answered = performance.answered()
        kinds.update(background(performance, told) for told in performance.events if told not in answered)
    rate = f" ({kinds.total() / background_min:.1f} a minute)" if background_min else ""
    named = ": " + ", ".join(f"{kind} {count}" for kind, count in kinds.most_common()) if kinds else ""
    return f"false alarms: {kinds.total()} in {background_min:.1f} minutes of everything else{rate}{named}"
