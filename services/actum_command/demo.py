"""`actum demo`: the paper's experiment with simulated people, through live processes."""

import signal
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.messages import Event, Truth
from actum.recording import Recording
from actum.runtime import Client, Listening, stop_on_signals
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.context import connect, console, fail, settings
from actum_command.demo_score import Score, line, summary, table
from actum_command.progress import bars
from actum_command.scene import write_examples
from actum_command.supervising import Supervisor
from actum_command.system import log_file, refuse_taken, restart_ended
from actum_model_trainer.baseline import nearest_neighbour
from actum_model_trainer.evaluation import Evaluation, evaluate
from actum_model_trainer.samples import samples_from
from actum_model_trainer.training import train
from scene_simulator.programme import ACTIONS
from som_classifier.model_loading import load_model
from som_classifier.presets import DEFAULT

ACTOR = 0
TRAINING_SEED, TEST_SEED = 1, 2
TRAINING_REPETITIONS, PEOPLE = 12, 9
READY_S = 30.0
TERMINATED = 143
LONGEST_SAMPLE_S = 4.5


def demo(
    people: Annotated[
        int, typer.Option(min=0, help="how many other people do the test; 0: the one of the training")
    ] = PEOPLE,
    repetitions: Annotated[int, typer.Option(min=1, help="test samples of each action and person")] = 1,
) -> None:
    """Train on one simulated person, then recognise people it has never seen, live, beside the paper's own results."""
    here = settings()
    refuse_taken(here.connect)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))  # as Ctrl-C does: the training ends where it is
    actors = list(range(ACTOR + 1, ACTOR + 1 + people)) or [ACTOR]
    with tempfile.TemporaryDirectory(prefix="actum-demo-") as folder:
        training, model = Path(folder) / "training.mcap", Path(folder) / "model.npz"
        learned = _train(training, model)
        baseline = _baseline(training, Path(folder), actors, repetitions)
        stop = stop_on_signals()  # looked at only where no process is being started: those that run end with this one
        score = _run_live(here, model, actors, repetitions, stop)
    console.print(table(score))
    console.print(summary(score, learned, baseline, people), soft_wrap=True)
    expected = len(actors) * repetitions * len(ACTIONS)
    if len(score.events) < expected:
        fail(f"only {len(score.events)} of {expected} events came; see {log_file('demo', here)}")
    log_file("demo", here).unlink(missing_ok=True)


def _baseline(training: Path, folder: Path, actors: Sequence[int], repetitions: int) -> Evaluation:
    tests = [folder / f"test-{actor}.mcap" for actor in actors]
    for actor, test in zip(actors, tests, strict=True):
        write_examples(test, repetitions, actor, TEST_SEED)
    return nearest_neighbour([Recording(training)], [Recording(test) for test in tests])


def _train(training: Path, model_file: Path) -> Evaluation:
    began_s = time.monotonic()
    write_examples(training, TRAINING_REPETITIONS, ACTOR, TRAINING_SEED)
    recordings = [Recording(training)]
    with bars() as progress:
        model = train(samples_from(recordings, progress).usable, DEFAULT, 0, progress)
        model.save(model_file)
        learned = evaluate(load_model(model_file), recordings, progress)
    console.print(
        f"trained on {learned.n} simulated samples of {len(ACTIONS)} actions in {time.monotonic() - began_s:.1f} s"
    )
    return learned


def _run_live(
    here: ServiceSettings, model: Path, actors: Sequence[int], repetitions: int, stop: threading.Event
) -> Score:
    """Start every process, let one actor after the other act, and collect one event per sample."""
    each = repetitions * len(ACTIONS)
    score = Score(expected=len(actors) * each)
    with Supervisor(log_file("demo", here)) as supervisor:
        services = processes.services(here, model, processes.simulated_objects())
        for program in (processes.router(here), *services, processes.scene(here)):
            supervisor.start(program)
        with connect(READY_S) as client:
            _wait_until_ready(client, stop)
            console.print(
                f"router, {', '.join(processes.SERVICES)} and scene_simulator run as processes of their own",
                soft_wrap=True,
            )
            listening = client.listen(keys.everything(here.sensor))
            for done, actor in enumerate(actors, start=1):
                simulator = processes.simulator(here, _acting(actor, repetitions))
                supervisor.start(simulator)
                _collect(listening, score, done * each, supervisor, stop)
                supervisor.end(simulator)
    return score


def _acting(actor: int, repetitions: int) -> list[str]:
    chosen = {"actor": actor, "seed": TEST_SEED, "repetitions": repetitions}
    return [word for name, value in chosen.items() for word in (f"--{name}", str(value))]


def _wait_until_ready(client: Client, stop: threading.Event) -> None:
    deadline_s = time.monotonic() + READY_S
    while time.monotonic() < deadline_s:
        _end_if(stop)
        running = {key.split("/")[-2] for key in client.alive()}
        if running >= set(processes.SERVICES) and client.wait_for_subscriber(keys.TRUTH, timeout_s=0.5):
            return
    fail(f"the services are not all up after {READY_S:g} s; see {log_file('demo', settings())}")


def _collect(listening: Listening, score: Score, until: int, supervisor: Supervisor, stop: threading.Event) -> None:
    deadline_s = time.monotonic() + (until - len(score.events)) * LONGEST_SAMPLE_S + READY_S
    while len(score.events) < until and time.monotonic() < deadline_s:
        _end_if(stop)
        received = listening.take()
        if received is None:
            time.sleep(0.01)
            restart_ended(supervisor)
        elif isinstance(received.message, Truth):
            score.truths[received.message.segment_id] = received.message
        elif isinstance(received.message, Event):
            score.events[received.message.segment_id] = received.message
            console.print(line(score, received.message), soft_wrap=True)


def _end_if(stop: threading.Event) -> None:
    if stop.is_set():
        sys.exit(TERMINATED)
