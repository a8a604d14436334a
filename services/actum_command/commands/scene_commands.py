"""`actum simulate` and `actum scene`: the simulated scene's labelled examples, and its marks."""

from pathlib import Path
from typing import Annotated

import typer

from actum.runtime import stop_on_signals
from actum_command.commands.terminal import connect_whenever, fail, refuse_ending, refuse_unwritable, say
from actum_command.scene_marks import mark_truth, write_examples
from scene_simulator.everyday import Choice, Pauses


def simulate(
    output: Annotated[Path, typer.Argument(help="the recording to write")],
    repetitions: Annotated[int, typer.Option(min=1, help="how often each of the five actions is done")] = 12,
    actor: Annotated[int, typer.Option(min=0, help="who acts")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="which repetitions")] = 0,
    everyday: Annotated[Choice, typer.Option(help="what people do between actions; only: nothing else")] = "none",
    minutes: Annotated[float, typer.Option(min=0, help="least length with everyday doings, which fill it up")] = 1.0,
    pauses: Annotated[
        Pauses, typer.Option(help="between actions up to three everyday doings and rests, or at most one")
    ] = "long",
) -> None:
    """Write labelled examples of the simulated scene, without images.

    With --everyday the person also scratches, phones, walks away and comes back, reaches for an object and draws back,
    all without marks: what a model has to answer with nothing. Train with "familiar", which leaves some kinds of doings
    out, and test with "all"; "only" has no actions.
    """
    refuse_unwritable(output)
    refuse_ending(output, ".mcap")
    if output.exists():
        fail(f"{output} is there already: name another file, or remove it")
    try:
        write_examples(output, repetitions, actor, seed, everyday, minutes, pauses)
    except OSError as error:
        fail(f"{output} cannot be written ({error.strerror})")
    actions = "no actions" if everyday == "only" else f"{repetitions} x 5 actions"
    say(f"{actions} of simulated actor {actor}, written to {output}")


def scene() -> None:
    """Put the start and end marks of the simulated scene, as an ordinary client."""
    with connect_whenever() as client:
        mark_truth(client, stop_on_signals())
