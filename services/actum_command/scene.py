"""The simulated scene seen from outside: its examples as recordings, its truth as marks."""

import threading
from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.messages import SIMULATOR, Segment, Truth
from actum.recording import Recorder
from actum.runtime import Client, stop_on_signals
from actum_command.context import connect_whenever, fail, refuse_ending, refuse_unwritable, say
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator, labelled_stream

POLL_S = 0.005


def simulate(
    output: Annotated[Path, typer.Argument(help="the recording to write")],
    repetitions: Annotated[int, typer.Option(min=1, help="how often each of the five actions is done")] = 12,
    actor: Annotated[int, typer.Option(min=0, help="who acts")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="which repetitions")] = 0,
) -> None:
    """Write labelled examples of the simulated scene, without images."""
    refuse_unwritable(output)
    refuse_ending(output, ".mcap")
    try:
        write_examples(output, repetitions, actor, seed)
    except OSError as error:
        fail(f"{output} cannot be written ({error.strerror})")
    say(f"{repetitions} x 5 actions of simulated actor {actor}, written to {output}")


def write_examples(output: Path, repetitions: int, actor: int, seed: int) -> None:
    """Record a balanced programme with its labels."""
    simulator = Simulator(balanced_programme(repetitions, seed, actor), actor, seed, image_hz=0)
    with Recorder(output, person=f"simulated {actor}", source="simulator", seed=str(seed)) as recorder:
        for message in labelled_stream(simulator):
            recorder.write(message)


def scene() -> None:
    """Put the start and end marks of the simulated scene, as an ordinary client."""
    with connect_whenever() as client:
        mark_truth(client, stop_on_signals())


def mark_truth(client: Client, stop: threading.Event) -> None:
    """Answer each truth with its mark, until stopped."""
    truths = client.listen(keys.key(keys.TRUTH, client.sensor))
    while not stop.is_set() and not client.wait_for_subscriber(keys.SEGMENT, timeout_s=0.5):
        pass
    while not stop.wait(POLL_S):
        while (received := truths.take()) is not None:
            if isinstance(received.message, Truth):
                client.put(mark_of(received.message))


def mark_of(truth: Truth) -> Segment:
    """The mark that a switch would have put: no action, no object, no hand."""
    return Segment(
        stamp_ns=truth.stamp_ns, sensor=truth.sensor, kind=truth.kind, segment_id=truth.segment_id, origin=SIMULATOR
    )
