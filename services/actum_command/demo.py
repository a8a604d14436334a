"""`actum demo`: the paper's experiment with simulated people, through live processes."""

import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.messages import Event, Truth
from actum.recording import Recording
from actum.runtime import Client, Listening
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.context import connect, console, fail, settings
from actum_command.demo_score import Score, line, summary, table
from actum_command.progress import bars
from actum_command.scene import write_examples
from actum_command.supervising import Supervisor
from actum_command.system import log_file, refuse_taken
from model_trainer.baseline import nearest_neighbour
from model_trainer.evaluation import Evaluation, evaluate
from model_trainer.samples import samples_from
from model_trainer.training import train
from sensor_gateway.simulator import ACTIONS
from som_classifier.model import Model
from som_classifier.presets import PAPER

ACTOR = 0
TRAINING_SEED, TEST_SEED = 1, 2
TRAINING_REPETITIONS, TEST_REPETITIONS = 12, 9
READY_S = 30.0
TERMINATED = 143
LONGEST_SAMPLE_S = 4.5


def demo(
    repetitions: Annotated[int, typer.Option(min=1, help="test samples of each action")] = TEST_REPETITIONS,
) -> None:
    """Train on 12 x 5 simulated samples, then recognise unseen ones live, beside the paper's own results."""
    here = settings()
    refuse_taken(here.connect)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))  # the processes it started end with it
    with tempfile.TemporaryDirectory(prefix="actum-demo-") as folder:
        training, test, model = (Path(folder) / name for name in ("training.mcap", "test.mcap", "model.npz"))
        write_examples(test, repetitions, ACTOR, TEST_SEED)
        learned = _train(training, model)
        baseline = nearest_neighbour([Recording(training)], [Recording(test)])
        score = _run_live(here, model, repetitions)
    console.print(table(score))
    console.print(summary(score, learned, baseline), soft_wrap=True)
    if len(score.events) < repetitions * len(ACTIONS):
        fail(f"only {len(score.events)} of {repetitions * len(ACTIONS)} events came; see {log_file('demo', here)}")


def _train(training: Path, model_file: Path) -> Evaluation:
    began_s = time.monotonic()
    write_examples(training, TRAINING_REPETITIONS, ACTOR, TRAINING_SEED)
    recordings = [Recording(training)]
    with bars() as progress:
        model = train(samples_from(recordings, progress).usable, PAPER, 0, progress)
        model.save(model_file)
        learned = evaluate(Model.load(model_file), recordings, progress)
    console.print(
        f"trained on {learned.n} simulated samples of {len(ACTIONS)} actions in {time.monotonic() - began_s:.1f} s"
    )
    return learned


def _run_live(here: ServiceSettings, model: Path, repetitions: int) -> Score:
    """Start every process, and collect one event per sample."""
    arguments = ["--source", "simulator", "--actor", str(ACTOR), "--seed", str(TEST_SEED)]
    arguments += ["--repetitions", str(repetitions)]
    with Supervisor(log_file("demo", here)) as supervisor:
        services = processes.services(here, model, processes.simulated_objects())
        for program in (processes.router(here), *services, processes.scene(here)):
            supervisor.start(program)
        with connect(READY_S) as client:
            _wait_until_ready(client)
            console.print(
                f"router, {', '.join(processes.SERVICES)} and sensor_gateway run as processes of their own",
                soft_wrap=True,
            )
            score = Score()
            listening = client.listen(keys.everything(here.sensor))
            supervisor.start(processes.gateway(here, arguments))
            _collect(listening, score, repetitions * len(ACTIONS), supervisor)
    return score


def _wait_until_ready(client: Client) -> None:
    deadline_s = time.monotonic() + READY_S
    while time.monotonic() < deadline_s:
        running = {key.split("/")[-2] for key in client.alive()}
        if running >= set(processes.SERVICES) and client.wait_for_subscriber(keys.TRUTH, timeout_s=0.5):
            return
    fail(f"the services are not all up after {READY_S:g} s; see {log_file('demo', settings())}")


def _collect(listening: Listening, score: Score, expected: int, supervisor: Supervisor) -> None:
    deadline_s = time.monotonic() + expected * LONGEST_SAMPLE_S + READY_S
    while len(score.events) < expected and time.monotonic() < deadline_s:
        received = listening.take()
        if received is None:
            time.sleep(0.01)
            for ended in supervisor.check():
                console.print(f"[yellow]{ended}[/yellow]")
        elif isinstance(received.message, Truth):
            score.truths[received.message.segment_id] = received.message
        elif isinstance(received.message, Event):
            score.events[received.message.segment_id] = received.message
            console.print(line(score, received.message, expected), soft_wrap=True)
