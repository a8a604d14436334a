"""The paper's experiment with simulated people: training on one, then recognition of others by live processes."""

import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.markup import escape

from actum import keys
from actum.messages import Event, Truth
from actum.recording import Recording
from actum.runtime import Client, Listening
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.demo_score import Score, line
from actum_command.scene_marks import write_examples
from actum_command.startup import log_file
from actum_command.supervising import Supervisor
from actum_model_trainer.baseline import nearest_neighbour
from actum_model_trainer.evaluation import Evaluation, evaluate
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import samples_from
from actum_model_trainer.training import train
from scene_simulator.programme import ACTIONS
from som_classifier.model_loading import load_model
from som_classifier.presets import DEFAULT

ACTOR = 0  # the actor of the training; the actors of the test have the numbers that follow
PEOPLE = 9  # actors of the test: the paper tests each action 9 times, here once with each actor
TRAINING_SEED = 1
TEST_SEED = 2  # another than in training, so that no repetition is the same as in training
TRAINING_REPETITIONS = 12  # enough samples of each action that more no longer help
READY_S = 30.0  # enough for all processes to start, also on a slow machine
LONGEST_SAMPLE_S = 4.5  # more than an action of the simulated scene takes with the pause after it
POLL_S = 0.01  # a third of a frame's interval
SUBSCRIBER_POLL_S = 0.5  # how soon a stop takes effect while the services start

Tell = Callable[[str], object]
"""Called with each line of console markup that says what has happened."""


class ExperimentError(RuntimeError):
    """The experiment did not finish; the text says why and names its log."""


class TerminatedError(Exception):
    """The experiment was asked to stop."""


def train_model(training: Path, model_file: Path, progress: Progress) -> Evaluation:
    """Train on examples of one simulated person, written to `training`; return the model's evaluation on them."""
    write_examples(training, TRAINING_REPETITIONS, ACTOR, TRAINING_SEED)
    recordings = [Recording(training)]
    train(samples_from(recordings, progress).usable, DEFAULT, 0, progress).save(model_file)
    return evaluate(load_model(model_file), recordings, progress)


def tested_actors(people: int) -> list[int]:
    """Return the actors of the test: `people` others than the training's, or the training's own where that is 0."""
    return list(range(ACTOR + 1, ACTOR + 1 + people)) or [ACTOR]


def nearest_neighbour_baseline(training: Path, folder: Path, actors: Sequence[int], repetitions: int) -> Evaluation:
    """Classify the samples of the live test by the nearest neighbour; recordings of them are written to `folder`."""
    tests = [folder / f"test-{actor}.mcap" for actor in actors]
    for actor, test in zip(actors, tests, strict=True):
        write_examples(test, repetitions, actor, TEST_SEED)
    return nearest_neighbour([Recording(training)], [Recording(test) for test in tests])


class LiveTest:
    """Runs router, services and simulated scene as processes of their own, and collects one event for each sample."""

    def __init__(self, here: ServiceSettings, stop: threading.Event, tell: Tell) -> None:
        self._here = here
        self._stop = stop
        self._tell = tell
        self._log = log_file("demo", here)

    def run(self, model: Path, actors: Sequence[int], repetitions: int) -> Score:
        """Start every process, let one actor after the other act, and return the score of all events.

        Raises:
            ExperimentError: the services do not come up.
            TerminatedError: the run was asked to stop.
            RouterUnreachableError, SettingsError, UnusableError: the processes cannot run as they are set.
        """
        samples_each = repetitions * len(ACTIONS)
        score = Score(expected=len(actors) * samples_each)
        with Supervisor(self._log) as supervisor:
            services = processes.services(self._here, model, processes.simulated_objects())
            for program in (processes.router(self._here), *services, processes.scene(self._here)):
                supervisor.start(program)
            with Client(self._here, READY_S) as client:
                self._wait_until_ready(client)
                self._tell(f"router, {', '.join(processes.SERVICES)} and scene_simulator run as processes of their own")
                listening = client.listen(keys.everything(self._here.sensor))
                for done, actor in enumerate(actors, start=1):
                    scene = {"--actor": actor, "--seed": TEST_SEED, "--repetitions": repetitions}
                    arguments = [word for flag, value in scene.items() for word in (flag, str(value))]
                    simulator = processes.simulator(self._here, arguments)
                    supervisor.start(simulator)
                    self._collect(listening, score, done * samples_each, supervisor)
                    supervisor.end(simulator)
        return score

    def _wait_until_ready(self, client: Client) -> None:
        deadline_s = time.monotonic() + READY_S
        while time.monotonic() < deadline_s:
            self._end_if_stopped()
            running = {key.split("/")[-2] for key in client.alive()}
            if running >= set(processes.SERVICES) and client.wait_for_subscriber(keys.TRUTH, SUBSCRIBER_POLL_S):
                return
        raise ExperimentError(f"the services are not all up after {READY_S:g} s; see {self._log}")

    def _collect(self, listening: Listening, score: Score, until: int, supervisor: Supervisor) -> None:
        """Add truths and events to the score until it has `until` events, or they take too long."""
        deadline_s = time.monotonic() + (until - len(score.events)) * LONGEST_SAMPLE_S + READY_S
        while len(score.events) < until and time.monotonic() < deadline_s:
            self._end_if_stopped()
            received = listening.take()
            if received is None:
                time.sleep(POLL_S)
                for ended in supervisor.restart_ended():
                    self._tell(f"[yellow]{escape(ended)}[/yellow]")
            elif isinstance(received.message, Truth):
                score.truths[received.message.segment_id] = received.message
            elif isinstance(received.message, Event):
                score.events[received.message.segment_id] = received.message
                self._tell(line(score, received.message))

    def _end_if_stopped(self) -> None:
        if self._stop.is_set():
            raise TerminatedError
