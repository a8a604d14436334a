"""The paper's experiment with simulated people: training on one, then recognition of others by live processes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from actum import keys
from actum.messages import Event, Message, Truth
from actum.recording import Recording
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.demo_score import Score, line
from actum_command.live_test import Appearance, LiveTest
from actum_command.scene_marks import write_examples
from actum_command.simulated_model import ACTOR, TRAINING_SEED
from actum_model_trainer.baseline import nearest_neighbour
from actum_model_trainer.evaluation import Evaluation, evaluate
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import samples_from
from actum_model_trainer.training import train
from scene_simulator.programme import ACTIONS
from som_classifier.model_loading import load_model
from som_classifier.presets import DEFAULT

FIRST_TESTED = ACTOR + 1  # the first actor of the test; the others have the numbers that follow
PEOPLE = 9  # actors of the test: the paper tests each action 9 times, here once with each actor
TEST_SEED = 2  # another than in training, so that no repetition is the same as in training
TRAINING_REPETITIONS = 12  # enough samples of each action that more no longer help
LONGEST_SAMPLE_S = 4.5  # more than an action of the simulated scene takes with the pause after it


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


def run_marked(live: LiveTest, here: ServiceSettings, model: Path, actors: Sequence[int], repetitions: int) -> Score:
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

    def take(self, message: Message) -> list[str]:
        """Take a message; return a line for an event."""
        if isinstance(message, Truth):
            self.score.truths[message.segment_id] = message
        elif isinstance(message, Event):
            self.score.events[message.segment_id] = message
            return [line(self.score, message)]
        return []
