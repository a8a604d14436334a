"""`actum demo`: the paper's experiment with simulated people, through live processes."""

import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Annotated

import typer

from actum.runtime import RouterUnreachableError, stop_on_signals
from actum.settings import SettingsError
from actum_command.commands.progress_bars import bars
from actum_command.commands.terminal import console, fail, settings
from actum_command.demo_score import summary, table
from actum_command.simulated_experiment import (
    PEOPLE,
    ExperimentError,
    LiveTest,
    TerminatedError,
    nearest_neighbour_baseline,
    tested_actors,
    train_model,
)
from actum_command.startup import log_file, refuse_taken
from actum_command.supervising import UnusableError
from actum_model_trainer.evaluation import Evaluation
from scene_simulator.programme import ACTIONS

TERMINATED = 128 + signal.SIGTERM  # the exit code that a shell reports for a process that SIGTERM ended


def demo(
    people: Annotated[
        int, typer.Option(min=0, help="how many other people do the test; 0: the one of the training")
    ] = PEOPLE,
    repetitions: Annotated[int, typer.Option(min=1, help="test samples of each action and person")] = 1,
) -> None:
    """Train on one simulated person, then recognise people it has never seen, live, beside the paper's own results."""
    here, actors = settings(), tested_actors(people)
    try:
        refuse_taken(here.connect)
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))  # ends the training at once, as Ctrl-C does
        with tempfile.TemporaryDirectory(prefix="actum-demo-") as folder:
            training, model = Path(folder) / "training.mcap", Path(folder) / "model.npz"
            learned = _train(training, model)
            baseline = nearest_neighbour_baseline(training, Path(folder), actors, repetitions)
            stop = stop_on_signals()  # not checked while processes start; they end with this one
            live = LiveTest(here, stop, lambda text: console.print(text, soft_wrap=True))
            score = live.run(model, actors, repetitions)
    except TerminatedError:
        sys.exit(TERMINATED)
    except (ExperimentError, RouterUnreachableError, SettingsError, UnusableError) as error:
        fail(str(error))
    console.print(table(score))
    console.print(summary(score, learned, baseline, people), soft_wrap=True)
    if len(score.events) < score.expected:
        fail(f"only {len(score.events)} of {score.expected} events came; see {log_file('demo', here)}")
    log_file("demo", here).unlink(missing_ok=True)


def _train(training: Path, model_file: Path) -> Evaluation:
    began_s = time.monotonic()
    with bars() as progress:
        learned = train_model(training, model_file, progress)
    console.print(
        f"trained on {learned.n} simulated samples of {len(ACTIONS)} actions in {time.monotonic() - began_s:.1f} s"
    )
    return learned
