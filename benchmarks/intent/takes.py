"""Takes of simulated people, and of motion capture."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from benchmarks.bimacs_tracks import Tracks, read

from action_fusion.intent.recent_paths import ARMS, SIDES
from actum.messages import Truth
from actum.node import SECOND_NS
from actum_dataset_importer.bimacs import HandsTake, read_take, take_files
from actum_model_trainer.foreseeing.takes import Contact, Take
from scene_simulator.everyday import chosen
from scene_simulator.noise import SkeletonNoise
from scene_simulator.parameters import Parameters, load_parameters
from scene_simulator.programme import ACTIONS, Task
from scene_simulator.random_streams import random_stream
from scene_simulator.simulated_scene import Scene, SceneState

LAYOUTS = ((3, 0.15), (3, 0.21), (3, 0.30), (5, 0.15), (5, 0.22))
"""Numbers of objects, and how far apart their places are (m)."""
TAIL_S = 2.0
"""How long a scene goes on after its last action."""
TASKS = 10
"""Actions in a simulated take."""
MOVED_M = 0.005
"""An object that has moved so far (m) has been touched."""
OBJECT_SD_M = 0.003
"""Standard deviation of an object's measured place (m), as the tracker has it at two metres."""
LATEST_MOTION_S = 1.0
"""How long after a labelled approach of the motion capture the object may begin to move (s)."""


def simulated(persons: Sequence[int], seed: int) -> list[Take]:
    """Return takes of simulated people in all layouts, as a depth camera sees them."""
    return [_simulated(scene_of(person, seed, *layout), f"{layout}") for person in persons for layout in LAYOUTS]


def everyday(persons: Sequence[int], seed: int, minutes: float, layout: tuple[int, float] = LAYOUTS[1]) -> list[Take]:
    """Return takes of simulated people who do everyday things, and now and then an action."""
    return [_simulated(scene_of(person, seed, *layout, 3, minutes), "everyday") for person in persons]


def scene_of(person: int, seed: int, objects: int, apart_m: float, tasks: int = TASKS, minutes: float = 0.0) -> Scene:
    """Return a scene with so many objects so far apart, and random actions on three of them."""
    rng = np.random.default_rng((person, seed))
    programme = [Task(str(rng.choice(ACTIONS)), int(rng.integers(1, 4))) for _ in range(tasks)]
    doings = chosen("all", minutes) if minutes else None
    return Scene(programme, person, seed, _with_objects(objects, apart_m), doings)


def scene_with_habits(person: int, seed: int, objects: int, apart_m: float, tasks: int, share: float) -> Scene:
    """Return a scene in which a share of each action is done to one of three objects, the rest to any of them."""
    rng = np.random.default_rng((person, seed, objects))
    usual = {action: int(rng.integers(1, 4)) for action in ACTIONS}
    programme = [
        Task(action, usual[action] if rng.random() < share else int(rng.integers(1, 4)))
        for action in rng.choice(ACTIONS, tasks).tolist()
    ]
    return Scene(programme, person, seed, _with_objects(objects, apart_m))


def _with_objects(count: int, apart_m: float) -> Parameters:
    parameters = load_parameters()
    items = parameters.objects.items
    more = [items[k].model_copy(update={"id": 4 + k, "name": f"other {items[k].name}"}) for k in range(count - 3)]
    places = tuple((k - (count - 1) / 2) * apart_m for k in range(count))
    changed = parameters.objects.model_copy(update={"items": (*items, *more), "place_x_m": places})
    return parameters.model_copy(update={"objects": changed})


def _simulated(scene: Scene, name: str, exact: bool = False) -> Take:
    """Play a scene: with the noise of a depth camera, or exact, as motion capture has it."""
    rate_hz, seeds = scene.parameters.camera.frame_rate_hz, scene.seeds
    noise = SkeletonNoise(
        random_stream("skeleton noise", *seeds), scene.parameters.noise, scene.actor.noise_scale, rate_hz
    )
    states = [state for state in scene.states(TAIL_S) if state.in_view]
    joints_m = [state.joints_m if exact else noise.measure(state.joints_m)[0] for state in states]
    placed = np.array([state.positions_m for state in states])
    seen_m = placed + np.random.default_rng(seeds).normal(0, OBJECT_SD_M, placed.shape)
    return Take(
        f"simulated {name}, {scene.seeds}",
        np.array([state.frame * SECOND_NS // rate_hz for state in states]),
        np.array(joints_m)[:, ARMS],
        {item.id: seen_m[:, k] for k, item in enumerate(scene.items)},
        list(contacts_of(scene, states)),
    )


def contacts_of(scene: Scene, states: Sequence[SceneState]) -> Iterator[Contact]:
    """Yield the true contacts of a scene."""
    rate_hz, began, touched = scene.parameters.camera.frame_rate_hz, states[0], None
    for state in states:
        if state.segment is None or state.target is None or state.segment == touched:
            continue
        if state.mark == "start":
            began = state
        action = scene.programme[state.segment].action
        moved_m = np.linalg.norm(state.positions_m[state.target] - began.positions_m[state.target])
        reach_s = scene.trials[state.segment].timing.reach_s
        arrived = action == "point" and (state.frame - began.frame) / rate_hz >= reach_s
        if arrived or moved_m > MOVED_M:
            touched = state.segment
            number = scene.items[state.target].id
            yield Contact(state.frame * SECOND_NS // rate_hz, SIDES.index(scene.actor.hand), number, action)


def bare(persons: Sequence[int], seed: int) -> list[Take]:
    """Return simulated takes as motion capture sees people: no bodies, hands marked elsewhere, all sizes and tempos."""
    return [_bare(scene_of(person, seed, *layout), f"{layout}") for person in persons for layout in LAYOUTS]


def _bare(scene: Scene, name: str) -> Take:
    take, rng = _simulated(scene, name, exact=True), np.random.default_rng(scene.seeds)
    tempo, size = rng.uniform(0.6, 1.6), rng.uniform(0.8, 1.15)
    arms_m, hands_m = np.full_like(take.arms_m, np.nan), take.arms_m[:, :2]
    jitter_m = rng.normal(0, rng.choice([0.001, 0.008, 0.015]), hands_m.shape)
    arms_m[:, :2] = size * (hands_m + rng.normal(0, 0.03, (2, 3)) + jitter_m)
    moved = [each._replace(stamp_ns=round(each.stamp_ns * tempo)) for each in take.contacts]
    places = {n: size * (path_m + rng.normal(0, 0.025, 3)) for n, path_m in take.objects_m.items()}
    stamps_ns = np.round(take.stamps_ns * tempo).astype(np.int64)
    return Take(take.name, stamps_ns, arms_m, places, moved)


def without_body(take: Take) -> Take:
    """Return a take of which only the hands are known."""
    arms_m = take.arms_m.copy()
    arms_m[:, 2:] = np.nan
    return replace(take, arms_m=arms_m)


def captured(folder: Path) -> list[Take]:
    """Return the takes of motion capture in a folder."""
    return [_captured(file) for file in take_files(folder)]


def _captured(file: Path) -> Take:
    take = read_take(file, "optitrack")
    tracks = read(take)
    arms_m = np.full((len(tracks.stamps_ns), len(ARMS), 3), np.nan)
    arms_m[:, :2] = np.stack([tracks.hands["right"], tracks.hands["left"]], axis=1)
    objects_m = {n: np.where(tracks.seen[n][:, None], path_m, np.nan) for n, path_m in tracks.objects.items()}
    contacts = sorted(_contact(tracks, truth) for truth in _reaches(take, tracks))
    return Take(take.name, tracks.stamps_ns, arms_m, objects_m, contacts)


def _reaches(take: HandsTake, tracks: Tracks) -> Iterator[Truth]:
    """Yield the labelled approaches, and the lifts of what that hand is not labelled to have approached."""
    known = [truth for truth in take.truths if truth.kind == "end" and truth.object_id in tracks.objects]
    hands = {truth.segment_id: (tracks.actors[truth.segment_id], truth.object_id) for truth in known}
    approached = {hands[truth.segment_id] for truth in known if truth.action == "approach"}
    for truth in known:
        if truth.action == "approach" or (truth.action == "lift" and hands[truth.segment_id] not in approached):
            yield truth


def _contact(tracks: Tracks, reach: Truth) -> Contact:
    """Return the first motion of the object that is reached for, or the end of the reach."""
    start_ns, end_ns = tracks.bounds[reach.segment_id]
    path_m = tracks.objects[reach.object_id]
    first = int(np.searchsorted(tracks.stamps_ns, start_ns))
    latest = int(np.searchsorted(tracks.stamps_ns, end_ns + LATEST_MOTION_S * SECOND_NS))
    rest_m = np.median(path_m[max(first - 20, 0) : first + 5], axis=0)
    moved = np.linalg.norm(path_m[first:latest] - rest_m, axis=1) > MOVED_M
    at_ns = int(tracks.stamps_ns[first + moved.argmax()]) if moved.any() else end_ns
    return Contact(at_ns, SIDES.index(tracks.actors[reach.segment_id]), reach.object_id, "approach")
