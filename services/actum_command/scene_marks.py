"""Marks and labelled examples of the simulated scene, made from its ground truth."""

import threading
from pathlib import Path

from actum import keys
from actum.messages import SIMULATOR, Segment, Truth
from actum.recorder import write_recording
from actum.runtime import Client
from scene_simulator.everyday import Choice, Pauses, chosen
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator, labelled_stream

POLL_S = 0.005  # a sixth of a frame's interval: marks come well before the next frame
SUBSCRIBER_POLL_S = 0.5  # how soon a stop takes effect while nobody listens to marks


def write_examples(
    output: Path,
    repetitions: int,
    actor: int,
    seed: int,
    everyday: Choice = "none",
    minutes: float = 0.0,
    pauses: Pauses = "long",
) -> None:
    """Record a balanced programme of the simulated scene with its labels, without images.

    Everyday doings between the actions fill the scene up to a number of minutes; with `only` it has no actions.

    Raises:
        OSError: the file cannot be written, or a recording lies there.
    """
    programme = [] if everyday == "only" else balanced_programme(repetitions, seed, actor)
    simulator = Simulator(programme, actor, seed, image_hz=0, everyday=chosen(everyday, minutes, pauses))
    write_recording(output, labelled_stream(simulator), person=f"simulated {actor}", source="simulator", seed=str(seed))


def mark_truth(client: Client, stop: threading.Event) -> None:
    """Put the mark of each ground-truth message, until stopped; no end of an action that had begun before."""
    started: set[str] = set()
    truths = client.listen(keys.key(keys.TRUTH, client.sensor))
    while not stop.is_set() and not client.wait_for_subscriber(keys.SEGMENT, SUBSCRIBER_POLL_S):
        pass
    while not stop.wait(POLL_S):
        while (received := truths.receive()) is not None:
            truth = received.message
            if isinstance(truth, Truth) and (truth.kind == "start" or truth.segment_id in started):
                started ^= {truth.segment_id}
                client.put(mark_of(truth))


def mark_of(truth: Truth) -> Segment:
    """Return the mark that a switch would have put: no action, no object, no hand."""
    return Segment(
        stamp_ns=truth.stamp_ns, sensor=truth.sensor, kind=truth.kind, segment_id=truth.segment_id, origin=SIMULATOR
    )
