"""The paper's experiment with simulated people, every action marked, and its score beside the paper's table 2."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from rich.markup import escape
from rich.table import Table

from actum import keys
from actum.messages import Event, Message, Truth
from actum.recording import Recording
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.demo.live_test import Appearance, LiveTest
from actum_command.describing import describe_event
from actum_command.scene_marks import write_examples
from actum_command.simulated_model import ACTOR, TRAINING_SEED
from actum_model_trainer.baseline import nearest_neighbour
from actum_model_trainer.evaluation import Evaluation, evaluate, wilson_interval
from actum_model_trainer.progress import Progress
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train
from scene_simulator.programme import ACTIONS
from som_classifier.model_loading import load_model
from som_classifier.presets import DEFAULT

FIRST_TESTED = ACTOR + 1  # the first actor of the test; the others have the numbers that follow
TEST_SEED = 2  # another than in training, so that no repetition is the same as in training
TRAINING_REPETITIONS = 12  # enough samples of each action that more no longer help
LONGEST_SAMPLE_S = 4.5  # more than an action of the simulated scene takes with the pause after it
TABLE_2: Mapping[str, tuple[int, int, int]] = MappingProxyType(
    {
        "push": (9, 9, 9),
        "pull": (9, 9, 9),
        "put": (9, 8, 9),
        "lift": (9, 8, 9),
        "point": (9, 7, 9),
    }
)
"""Table 2 of the paper (its own actor, its own Kinect, online): by action the tests, actions and objects recognised."""


@dataclass
class Score:
    """The ground truth of segments beside their events.

    Attributes:
        expected: how many events there will be.
        truths: the ground truth by segment id.
        events: the events that have come, by segment id.
    """

    expected: int
    truths: dict[str, Truth] = field(default_factory=dict)
    events: dict[str, Event] = field(default_factory=dict)

    def action_right(self, segment_id: str) -> bool:
        """Whether the event names the action that was done."""
        return self.events[segment_id].action == self.truths[segment_id].action

    def object_right(self, segment_id: str) -> bool:
        """Whether the event names the object it was done to."""
        answered = self.events[segment_id].object
        return answered is not None and answered.id == self.truths[segment_id].object_id

    def of(self, action: str) -> list[str]:
        """List the answered segments of an action."""
        return [name for name, truth in self.truths.items() if truth.action == action and name in self.events]

    def objects_by_majority(self) -> int:
        """Count the objects that are right if each action's most frequent object is answered for all its segments."""
        return objects_by_majority(self.truths[name] for action in TABLE_2 for name in self.of(action))


def objects_by_majority(done: Iterable[Truth]) -> int:
    """Count the objects that are right if each action's most frequent object is answered whenever it is done."""
    objects: defaultdict[str, Counter[int]] = defaultdict(Counter)
    for truth in done:
        objects[truth.action][truth.object_id] += 1
    return sum(max(counts.values()) for counts in objects.values())


def train_model(training: Path, model_file: Path, progress: Progress) -> Evaluation:
    """Train on examples of one simulated person, written to `training`; return the model's evaluation on them."""
    write_examples(training, TRAINING_REPETITIONS, ACTOR, TRAINING_SEED)
    recordings = [Recording(training)]
    train(samples_from(recordings, progress).usable, DEFAULT, 0, progress).save(model_file)
    return evaluate(load_model(model_file), recordings, progress)


def tested_actors(first: int, people: int) -> list[int]:
    """Return the actors of the test: `people` from the first one on, or the training's own where that is 0."""
    return list(range(first, first + people)) or [ACTOR]


def nearest_neighbour_baseline(training: Path, folder: Path, actors: Sequence[int], repetitions: int) -> Evaluation:
    """Classify the samples of the live test by the nearest neighbour; recordings of them are written to `folder`."""
    tests = [folder / f"test-{actor}.mcap" for actor in actors]
    for actor, test in zip(actors, tests, strict=True):
        write_examples(test, repetitions, actor, TEST_SEED)
    return nearest_neighbour([Recording(training)], [Recording(test) for test in tests])


def run(live: LiveTest, here: ServiceSettings, model: Path, actors: Sequence[int], repetitions: int) -> Score:
    """Let one actor after the other act, with every action marked, and return the score of all events.

    Raises:
        ExperimentError: the services do not come up.
        TerminatedError: the run was asked to stop.
        RouterUnreachableError, SettingsError, UnusableError: the processes cannot run as they are set.
    """
    samples_each = repetitions * len(ACTIONS)
    score = Score(expected=len(actors) * samples_each)
    programs = [*processes.services(here, model, processes.simulated_objects()), processes.scene(here)]
    programs = processes.with_page(here, programs)
    live.run(programs, keys.TRUTH, _appearances(score, actors, repetitions))
    return score


def _appearances(score: Score, actors: Sequence[int], repetitions: int) -> Iterator[Appearance]:
    samples_each = repetitions * len(ACTIONS)
    for done, actor in enumerate(actors, start=1):
        scene = {"--actor": actor, "--seed": TEST_SEED, "--repetitions": repetitions}
        yield Appearance(scene, MarkedWitness(score, done * samples_each))


@dataclass
class MarkedWitness:
    """Adds truths and events to the score until it has `until` events."""

    score: Score
    until: int

    @property
    def satisfied(self) -> bool:
        """Whether all events have come."""
        return len(self.score.events) >= self.until

    @property
    def longest_s(self) -> float:
        """Seconds that the actions may take which have no event yet."""
        return (self.until - len(self.score.events)) * LONGEST_SAMPLE_S

    def receive(self, message: Message) -> list[str]:
        """Receive a message; return a line for an event."""
        if isinstance(message, Truth):
            self.score.truths[message.segment_id] = message
        elif isinstance(message, Event):
            self.score.events[message.segment_id] = message
            return [line(self.score, message)]
        return []


def line(score: Score, event: Event) -> str:
    """Describe one event as console markup, and whether action and object are right."""
    truth = score.truths.get(event.segment_id)
    if truth is None:
        return f"[yellow]{escape(event.segment_id)} is of no action of the scene[/yellow]"
    done = f'{truth.action} {truth.object_id} "{truth.object_name}"'
    verdicts = [
        verdict("action", score.action_right(event.segment_id)),
        verdict("object", score.object_right(event.segment_id)),
    ]
    return f"{len(score.events):3}/{score.expected}  {escape(done):16}  {'  '.join(verdicts)}  {describe_event(event)}"


def table(score: Score) -> Table:
    """Lay out the paper's table 2 beside this run."""
    return paper_table({action: _counts(score, action) for action in TABLE_2})


def paper_table(counted: Mapping[str, tuple[int, int, int]]) -> Table:
    """Lay out the paper's table 2 beside a run's numbers of tests, of right actions and of right objects, by action."""
    result = Table("action", title="table 2 of the paper, and this run")
    for heading in ("paper: tests", "action", "object", "here: tests", "action", "object"):
        result.add_column(heading, justify="right", overflow="fold")
    rows = {action: (*counts, *counted[action]) for action, counts in TABLE_2.items()}
    for action, counts in rows.items():
        result.add_row(action, *_cells(counts))
    result.add_section()
    result.add_row("total", *_cells(tuple(map(sum, zip(*rows.values(), strict=True)))), style="bold")
    return result


def summary(score: Score, learned: Evaluation, baseline: Evaluation, people: int) -> str:
    """Return the summary of the demo's results, with those of a much simpler method."""
    right = sum(score.action_right(name) for action in TABLE_2 for name in score.of(action))
    tests = len(score.events)
    low, high = wilson_interval(right, tests)
    tested = f"{people} others of other heights, tempos and handedness" if people else "the same person"
    return (
        f"training samples learned: {learned.correct} of {learned.n}; "
        f"unseen samples recognised: {right} of {tests} (95 % interval {low:.0%} to {high:.0%})\n"
        f"objects that the action alone would tell: {score.objects_by_majority()} of {tests}\n"
        f"1-NN on the raw path of the hand, same samples: {baseline.correct} of {baseline.n}\n"
        f"Here: learned from one simulated person, tested on {tested}, live processes. "
        "The paper: one person, a Kinect."
    )


def verdict(what: str, right: bool) -> str:
    """Write as console markup whether something is right."""
    return f"[green]{what} ✓[/green]" if right else f"[red]{what} ✗[/red]"


def _counts(score: Score, action: str) -> tuple[int, int, int]:
    names = score.of(action)
    return len(names), sum(map(score.action_right, names)), sum(map(score.object_right, names))


def _cells(counts: tuple[int, ...]) -> list[str]:
    """Return a row's cells: the numbers of tests, and the counts of right actions and objects with their shares."""
    paper_tests, paper_right, paper_object, tests, right, right_objects = counts
    return [
        str(paper_tests), _share(paper_right, paper_tests), _share(paper_object, paper_tests),
        str(tests), _share(right, tests), _share(right_objects, tests),
    ]  # fmt: skip


def _share(count: int, of: int) -> str:
    return f"{count} ({count / of:.1%})" if of else "-"
