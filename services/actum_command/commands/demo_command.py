"""`actum demo`: the paper's experiment with simulated people, through live processes."""

import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Annotated

import typer

from actum.runtime import RouterUnreachableError, stop_on_signals
from actum.settings import ServiceSettings, SettingsError
from actum_command.commands.progress_bars import bars
from actum_command.commands.terminal import console, fail, settings
from actum_command.demo import marked as with_marks
from actum_command.demo import unmarked as without_marks
from actum_command.demo.live_test import ExperimentError, LiveTest, TerminatedError, log_file
from actum_command.simulated_model import SIMULATED_MODEL, learned_from
from actum_command.startup import refuse_taken
from actum_command.supervising import UnusableError
from scene_simulator.programme import ACTIONS
from som_classifier.model_loading import load_model

SHOWN = 2
"""How many people act in the demo unless another number is named: a minute and a half shows what it is."""
TERMINATED = 128 + signal.SIGTERM  # the exit code that a shell reports for a process that SIGTERM ended


def demo(
    people: Annotated[
        int,
        typer.Option(
            min=0,
            help=(
                "number of simulated people to test on; the model was trained on other people. With 0, the test uses "
                "one person on whom the model was trained"
            ),
        ),
    ] = SHOWN,
    repetitions: Annotated[int, typer.Option(min=1, help="number of times that each person does each action")] = 1,
    marked: Annotated[
        bool,
        typer.Option(
            "--marked",
            help=(
                "repeat the experiment of the paper that actum implements (Gharaee et al. 2017): train on one "
                "simulated person, and give the classifier the start and end of every action"
            ),
        ),
    ] = False,
) -> None:
    """Test recognition on simulated people on whom the model was not trained, and print the scores.

    Beside the scores, the command prints the published scores of the paper that actum implements (Gharaee et al. 2017).
    The test needs no camera and no other running program. Between the actions, the people do other things, such as
    scratching, and nobody marks where an action starts or ends. The test takes 45 s per person. With --people 9, each
    action is tested 9 times, as in the paper.
    """
    here = settings()
    try:
        refuse_taken(here.connect)
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))  # ends the training at once, as Ctrl-C does
        lack = (_marked if marked else _unmarked)(here, people, repetitions)
    except TerminatedError:
        sys.exit(TERMINATED)
    except (ExperimentError, RouterUnreachableError, SettingsError, UnusableError) as error:
        fail(str(error))
    if lack is not None:
        fail(f"{lack}; see {log_file(here)}")
    log_file(here).unlink(missing_ok=True)


def _marked(here: ServiceSettings, people: int, repetitions: int) -> str | None:
    """Run the paper's experiment and print its results; return what is missing, None where nothing is."""
    actors = with_marks.tested_actors(with_marks.FIRST_TESTED, people)
    with tempfile.TemporaryDirectory(prefix="actum-demo-") as name:
        folder = Path(name)
        training, model = folder / "training.mcap", folder / "model.npz"
        began_s = time.monotonic()
        with bars() as progress:
            learned = with_marks.train_model(training, model, progress)
        console.print(
            f"trained on {learned.n} simulated samples of {len(ACTIONS)} actions in {time.monotonic() - began_s:.1f} s"
        )
        baseline = with_marks.nearest_neighbour_baseline(training, folder, actors, repetitions)
        score = with_marks.run(_live(here), here, model, actors, repetitions)
    console.print(with_marks.table(score))
    console.print(with_marks.summary(score, learned, baseline, people), soft_wrap=True)
    return (
        f"only {len(score.events)} of {score.expected} events arrived" if len(score.events) < score.expected else None
    )


def _unmarked(here: ServiceSettings, people: int, repetitions: int) -> str | None:
    """Run the experiment without marks and print its results; return what is missing, None where nothing is."""
    actors = with_marks.tested_actors(without_marks.FIRST_UNSEEN, people)
    console.print(without_marks.introduction(len(actors)), soft_wrap=True)
    learned = learned_from(load_model(SIMULATED_MODEL))
    performances = without_marks.run(_live(here), here, SIMULATED_MODEL, actors, repetitions)
    console.print(without_marks.table(performances))
    console.print(without_marks.summary(performances, learned, people), soft_wrap=True)
    unfinished = [performance.person for performance in performances if not performance.over]
    if unfinished:
        return f"the scene of {', '.join(unfinished)} did not end in time"
    return None if any(performance.events for performance in performances) else "no event arrived"


def _live(here: ServiceSettings) -> LiveTest:
    stop = stop_on_signals()  # not checked while processes start; they end with this one
    return LiveTest(here, stop, lambda text: console.print(text, soft_wrap=True))
