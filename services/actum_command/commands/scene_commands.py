"""`actum simulate` and `actum scene`: the simulated scene's labelled examples, and its marks."""

from pathlib import Path
from typing import Annotated

import typer

from actum.runtime import stop_on_signals
from actum_command.commands.recording_options import refuse_output
from actum_command.commands.terminal import connect_whenever, fail, say
from actum_command.scene_marks import mark_truth, write_examples
from scene_simulator.everyday import Choice, Pauses
from scene_simulator.settings import Settings

SCENE = Settings.model_fields
"""The settings of the simulated scene, some of which a recording of it has too."""


def simulate(
    output: Annotated[Path, typer.Argument(help="the recording to write (.mcap)")],
    repetitions: Annotated[
        int,
        typer.Option(
            min=1,
            help="number of times that the person does each of the five actions; ignored if --everyday is 'only'",
        ),
    ] = 12,
    actor: Annotated[int, typer.Option(min=0, help=SCENE["actor"].description)] = 0,
    seed: Annotated[int, typer.Option(min=0, help=SCENE["seed"].description)] = 0,
    everyday: Annotated[Choice, typer.Option(help=SCENE["everyday"].description)] = "none",
    minutes: Annotated[float, typer.Option(min=0, help=SCENE["minutes"].description)] = 1.0,
    pauses: Annotated[Pauses, typer.Option(help=SCENE["pauses"].description)] = "long",
) -> None:
    """Write a recording of simulated actions with their labels, without images, for training or testing.

    With --everyday, the person also does background activities, such as scratching, phoning or walking away. A model
    should not recognise these activities as actions. Train with --everyday familiar and test with --everyday all,
    because all includes kinds of background activity that familiar omits.
    """
    refuse_output(output)
    try:
        write_examples(output, repetitions, actor, seed, everyday, minutes, pauses)
    except OSError as error:
        fail(f"{output} cannot be written ({error.strerror}): give another file")
    actions = "no actions" if everyday == "only" else f"{repetitions} x 5 actions"
    say(f"{actions} of simulated actor {actor}, written to {output}")


def scene() -> None:
    """Publish start and end marks for the actions of the simulated scene, until Ctrl-C.

    Use this command while 'actum up' runs, to see how marked actions are recognised. With 'actum up --marked', you do
    not need this command, because 'actum up' then publishes the same marks.
    """
    with connect_whenever() as client:
        mark_truth(client, stop_on_signals())
