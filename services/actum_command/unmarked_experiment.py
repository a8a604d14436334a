"""The same experiment without marks: people act and do everyday things in one continuous scene each."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

from actum import keys
from actum.node import SECOND_NS
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.live_test import Appearance, LiveTest
from actum_command.performance import Doing, Performance
from actum_command.simulated_experiment import TEST_SEED
from actum_command.simulated_model import PAUSES
from actum_command.unmarked_score import PersonWitness
from scene_simulator.everyday import chosen
from scene_simulator.programme import ACTIONS, balanced_programme
from scene_simulator.simulated_scene import Scene

FIRST_UNSEEN = 101
"""The first actor of the test: people that no choice was made on, as how many teach and how often was on 1 to 9."""


def run_unmarked(
    live: LiveTest, here: ServiceSettings, model: Path, actors: Sequence[int], repetitions: int
) -> list[Performance]:
    """Let one actor after the other act and do everyday things, and return what was done and told.

    Raises:
        ExperimentError: the services do not come up.
        TerminatedError: the run was asked to stop.
        RouterUnreachableError, SettingsError, UnusableError: the processes cannot run as they are set.
    """
    programs = processes.services(here, model, processes.simulated_objects(), {"segments": ["auto"]})
    programs = processes.with_page(here, programs)
    performances: list[Performance] = []
    live.run(programs, keys.SKELETON, _appearances(performances, actors, repetitions))
    return performances


def _appearances(performances: list[Performance], actors: Sequence[int], repetitions: int) -> Iterator[Appearance]:
    """Yield each actor's scene, and add what is heard of it to the performances."""
    actions = repetitions * len(ACTIONS)
    for before, actor in enumerate(actors):
        scene = {"--actor": actor, "--seed": TEST_SEED, "--repetitions": repetitions}
        continuous = {"--everyday": "all", "--minutes": 0, "--pauses": PAUSES}
        doings, longest_s = _doings(actor, repetitions)
        performance = Performance(f"person {actor}", actions, doings)
        performances.append(performance)
        witness = PersonWitness(performance, before * actions, len(actors) * actions, longest_s)
        yield Appearance(scene | continuous, witness)


def _doings(actor: int, repetitions: int) -> tuple[list[Doing], float]:
    """Return the everyday doings of the scene that the simulator plays for an actor, and how long it is (s)."""
    programme = balanced_programme(repetitions, TEST_SEED, actor)
    scene = Scene(programme, actor, TEST_SEED, everyday=chosen("all", 0, PAUSES))
    frame_ns = SECOND_NS // scene.parameters.camera.frame_rate_hz
    doings, frames = [], 0
    for kind, states in groupby(scene.states(), key=lambda state: state.doing):
        first, frames = frames, frames + sum(1 for _ in states)
        if kind is not None:
            doings.append(Doing(kind, first * frame_ns, frames * frame_ns))
    return doings, frames * frame_ns / SECOND_NS
