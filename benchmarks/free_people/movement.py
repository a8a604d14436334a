"""People who move freely, by random numbers: the movement that training holds against what was taught."""

from collections.abc import Iterator

import numpy as np
from benchmarks.free_people.body import BOTH, RATE_HZ, FreeBody, FreePose
from benchmarks.free_people.phrases import PHRASES

from actum.arrays import Array
from actum.messages import Agent, Skeleton
from actum.node import SECOND_NS
from scene_simulator.actor import Actor, draw_actor
from scene_simulator.inverse_kinematics import Stance, pose
from scene_simulator.noise import SkeletonNoise, Sway
from scene_simulator.parameters import load_parameters
from scene_simulator.random_streams import random_stream
from scene_simulator.simulator import AGENT

LIKING = 2.0
"""Shape of the gamma distribution of a person's liking for a phrase: some are several times as frequent."""
RESTING = 0.7
"""How often a person comes to rest after a phrase."""
HANDS_ON_BODY = 0.2
"""How often the hands rest on the body, else they hang."""
DISTANCE_M = 2.6
"""From the camera."""


def free_movement(person: int, seconds: float, sensor: str) -> Iterator[Skeleton]:
    """Yield noisy skeletons of a person, 30 a second; the same person, the same skeletons, bit for bit."""
    parameters, rng = load_parameters(), random_stream("free movement", person)
    actor = draw_actor(parameters.actor, person)
    values = _moved(FreeBody(actor, rng), seconds)
    sway = Sway(rng, parameters.sway).at(np.arange(len(values)) / RATE_HZ)
    joints_m = _joints(actor, values, sway)
    noise = SkeletonNoise(rng, parameters.noise, actor.noise_scale, RATE_HZ)
    for frame, true_m in enumerate(joints_m):
        measured_m, confidence = noise.measure(true_m)
        agent = Agent(agent=AGENT, joints=measured_m.tolist(), confidence=confidence)
        yield Skeleton(
            stamp_ns=frame * SECOND_NS // RATE_HZ, sensor=sensor, agents=[agent], session_id=f"free-{person}"
        )


def _moved(body: FreeBody, seconds: float) -> Array:
    """Let the body move, phrase after phrase; return the values (T, 13) of its poses."""
    phrases, often = list(PHRASES), np.array(list(PHRASES.values()))
    liking = body.rng.gamma(LIKING * often)
    while body.seconds < seconds:
        phrases[body.rng.choice(len(phrases), p=liking / liking.sum())](body)
        if body.chance(RESTING):
            _rest(body)
    return np.concatenate(body.frames)[: round(seconds * RATE_HZ)]


def _rest(body: FreeBody) -> None:
    """Stand, the hands hanging or on the body."""
    turn_rad = body.pose.turn_rad if body.chance(0.5) else 0.0
    standing = FreePose(body.hanging(), turn_rad)
    if body.chance(HANDS_ON_BODY):
        standing = standing.with_hands({hand: body.on_body(hand) for hand in BOTH})
    body.reach(standing, body.log_uniform(0.6, 2.5))
    body.hold(body.log_uniform(0.1, 3.0))


def _joints(actor: Actor, values: Array, sway: Array) -> Array:
    """Return the joints (T, 15, 3; m, camera frame) of poses' values (T, 13) with sway (T, 3)."""
    hands, (turn, twist, lean), legs = (
        values[:, :6].reshape(-1, 2, 3),
        values[:, 6:9].T,
        values[:, 9:].reshape(-1, 2, 2),
    )
    pelvis = np.tile((actor.stand_x_m, 0.0, DISTANCE_M), (len(values), 1))
    heading, free = actor.heading_rad - turn, np.zeros(len(values))
    left, _, forward = Stance(pelvis, heading, lean).axes()
    pelvis = pelvis + sway[:, :1] * left + sway[:, 1:2] * forward
    stance = Stance(pelvis, heading, actor.lean_rad + lean + sway[:, 2], twist, free, legs)
    hands_m = stance.pelvis_m[:, None] + np.einsum("thk,ktd->thd", hands, np.stack(stance.axes()))
    return pose(actor, stance, hands_m)
