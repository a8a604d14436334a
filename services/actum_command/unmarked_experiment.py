"""The same experiment without marks: people act and do everyday things in one continuous scene each."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

from actum import keys
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.live_test import Appearance, LiveTest
from actum_command.performance import Doing, Performance
from actum_command.scene_marks import write_examples
from actum_command.simulated_experiment import ACTOR, TEST_SEED, TRAINING_SEED
from actum_command.unmarked_score import PersonWitness
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import samples_from
from actum_model_trainer.training import train_to_spot
from scene_simulator.everyday import Pauses, chosen
from scene_simulator.programme import ACTIONS, balanced_programme
from scene_simulator.simulated_scene import Scene
from som_classifier.presets import DEFAULT

TRAINERS = (ACTOR, *range(1001, 1009))
"""Actors of the training: numbers that no test of up to 900 people has."""
FIRST_UNSEEN = 101
"""The first actor of the test: people that no choice was made on, as how many teach and how often was on 1 to 9."""
TRAINING_REPETITIONS = 2
"""Of each action by each of them: many people teach more than many repetitions, and half a minute is enough."""
PAUSES: Pauses = "short"
"""At most one everyday doing between two actions: the test of nine people then takes seven minutes, not fifteen."""


def train_on_streams(folder: Path, model_file: Path, progress: Progress) -> str:
    """Train on continuous recordings of several people, written to a folder; return what was learnt from, in words."""
    recordings = []
    for actor in TRAINERS:
        file = folder / f"training-{actor}.mcap"
        write_examples(file, TRAINING_REPETITIONS, actor, TRAINING_SEED, "familiar", pauses=PAUSES)
        recordings.append(Recording(file))
    samples = samples_from(recordings, progress)
    train_to_spot(samples.usable, samples.streams, DEFAULT, 0, progress).save(model_file)
    minutes = sum(int(stream.stamps_ns[-1] - stream.stamps_ns[0]) for stream in samples.streams) / (60 * SECOND_NS)
    return f"{minutes:.0f} minutes of {len(TRAINERS)} simulated people with {len(samples.usable)} actions"


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
