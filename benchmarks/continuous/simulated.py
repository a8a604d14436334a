"""Simulated people whom nobody marks: at a table with three objects, with everyday doings between the actions."""

from pathlib import Path

from actum.recorder import Recorder
from actum.recording import Recording
from scene_simulator.everyday import Everyday
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator, labelled_stream

TAUGHT, TAUGHT_REPETITIONS = range(9), 3
"""Who teaches, with the everyday doings that are `FAMILIAR`, and how often they do each of the five actions."""
TESTED, TESTED_REPETITIONS = range(20, 29), 2
"""Who is tested, with `ALL` doings: 90 actions."""


def scene_of(person: int, repetitions: int, everyday: Everyday, image_hz: int = 0) -> Simulator:
    """Return a scene of one person; the same arguments, the same scene. Without repetitions nothing is done in it."""
    programme = balanced_programme(repetitions, person, person) if repetitions else []
    return Simulator(programme, person, person, image_hz=image_hz, everyday=everyday)


def recording_of(person: int, repetitions: int, everyday: Everyday, folder: Path) -> Recording:
    """Record a scene without images, with its labels."""
    path = folder / f"{person:02d}.mcap"
    with Recorder(path, person=str(person), source="simulator") as recorder:
        for message in labelled_stream(scene_of(person, repetitions, everyday)):
            recorder.write(message)
    return Recording(path)
