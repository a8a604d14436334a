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
    output: Annotated[Path, typer.Argument(help="the recording to write")],
    repetitions: Annotated[int, typer.Option(min=1, help="repetitions of each of the five actions")] = 12,
    actor: Annotated[int, typer.Option(min=0, help="number of the simulated person")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="seed of the random variation between repetitions")] = 0,
    everyday: Annotated[
        Choice, typer.Option(help="everyday activities between the actions; only: no actions at all")
    ] = "none",
    minutes: Annotated[
        float, typer.Option(min=0, help="least length with everyday activities, which fill the remaining time (min)")
    ] = 1.0,
    pauses: Annotated[
        Pauses,
        typer.Option(
            help="pauses between actions; long: up to three everyday activities and rests; short: at most one"
        ),
    ] = "long",
) -> None:
    """Write labelled examples of the simulated scene, without images.

    With --everyday the person also scratches, phones, walks away and comes back, or reaches for an object and draws
    back, all without marks: a model should not answer these. Train with --everyday familiar, which leaves out some
    kinds of activities, and test with --everyday all. With --everyday only the person does none of the actions.
    """
    refuse_output(output)
    try:
        write_examples(output, repetitions, actor, seed, everyday, minutes, pauses)
    except OSError as error:
        fail(f"{output} cannot be written ({error.strerror})")
    actions = "no actions" if everyday == "only" else f"{repetitions} x 5 actions"
    say(f"{actions} of simulated actor {actor}, written to {output}")


def scene() -> None:
    """Publish the start and end marks of the simulated scene, as an ordinary client does."""
    with connect_whenever() as client:
        mark_truth(client, stop_on_signals())
