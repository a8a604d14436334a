"""`actum simulate` and `actum scene`: the simulated scene's labelled examples, and its marks."""

from pathlib import Path
from typing import Annotated

import typer

from actum.runtime import stop_on_signals
from actum_command.commands.recording_options import refuse_output
from actum_command.commands.terminal import connect_whenever, fail, say
from actum_command.scene_marks import mark_truth, write_examples
from scene_simulator.everyday import Choice, Pauses


def simulate(
    output: Annotated[Path, typer.Argument(help="the recording to write (.mcap)")],
    repetitions: Annotated[
        int,
        typer.Option(
            min=1,
            help="number of times that the person does each of the five actions; ignored if --everyday is 'only'",
        ),
    ] = 12,
    actor: Annotated[
        int,
        typer.Option(
            min=0,
            help=(
                "number of the simulated person who acts; each person has another body height, tempo and preferred hand"
            ),
        ),
    ] = 0,
    seed: Annotated[
        int,
        typer.Option(
            min=0, help="seed of the random variation between repetitions; the same seed gives the same movements"
        ),
    ] = 0,
    everyday: Annotated[
        Choice,
        typer.Option(
            help=(
                "background activities between the actions, such as scratching: none; familiar (only some kinds, to "
                "train a model with); all (all kinds, to test a model with); only (all kinds, and no actions)"
            )
        ),
    ] = "none",
    minutes: Annotated[
        float,
        typer.Option(
            min=0,
            help=(
                "minimum length of the scene in minutes; the background activities of --everyday fill the time after "
                "the last action. Ignored if --everyday is none"
            ),
        ),
    ] = 1.0,
    pauses: Annotated[
        Pauses,
        typer.Option(
            help=(
                "what the simulated person does between two actions. long: up to three background activities, and "
                "rests of several seconds; short: at most one background activity, and short rests. Ignored if "
                "--everyday is none"
            )
        ),
    ] = "long",
) -> None:
    """Write a recording of simulated actions with their labels, without images, for training or testing.

    With --everyday the person also shows background activities, such as scratching, phoning or walking away, which a
    model should not recognise as actions. Train with --everyday familiar and test with --everyday all, which includes
    kinds of background activity that familiar omits.
    """
    refuse_output(output)
    try:
        write_examples(output, repetitions, actor, seed, everyday, minutes, pauses)
    except OSError as error:
        fail(f"{output} cannot be written ({error.strerror})")
    actions = "no actions" if everyday == "only" else f"{repetitions} x 5 actions"
    say(f"{actions} of simulated actor {actor}, written to {output}")


def scene() -> None:
    """Publish start and end marks for the actions of the simulated scene, until Ctrl-C.

    Use this command to try recognition with marks if 'actum up' was started without --marked.
    """
    with connect_whenever() as client:
        mark_truth(client, stop_on_signals())
