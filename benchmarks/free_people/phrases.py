"""Phrases of free movement: strokes, swings, circles, kicks, steps, crouching, sitting, bowing, turning, touching."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from benchmarks.free_people.body import BOTH, FreeBody, FreePose

from actum.arrays import Array
from scene_simulator.motion import SIDES

BOTH_HANDS, ACTING_HAND = 0.40, 0.45
"""How often both hands move, and how often the acting one alone; else the other."""
ALIKE = 0.6
"""How often two hands go to places that mirror each other."""
FASTEST_M_S = 0.6
"""Amplitude times frequency of a repeated movement at most: 3.8 m/s at its middle."""
BENT_ARMS_M = ((0.20, 0.12, 0.25), (-0.20, 0.12, 0.25))
"""Hands of somebody who runs on the spot."""


def strokes(body: FreeBody) -> None:
    """Move the hands to some places, slowly as in reaching or fast as in throwing and hitting."""
    hands, speed_m_s = _hands(body), body.log_uniform(0.6, 4.0)
    for _ in range(body.rng.integers(1, 5)):
        body.reach(_with_trunk(body, body.pose.with_hands(_places(body, hands, body.anywhere))), speed_m_s)
        if body.chance(0.3):
            body.hold(body.uniform(0.05, 1.0))


def swings(body: FreeBody) -> None:
    """Move the hands to and fro about some places, as in waving, hammering and sawing."""
    hands = _hands(body)
    body.reach(body.pose.with_hands(_places(body, hands, body.anywhere)), body.log_uniform(0.6, 3.0))
    amplitude_m, way = body.log_uniform(0.03, 0.4), body.rng.normal(size=3)
    way_m = amplitude_m * way / np.linalg.norm(way)
    moved = {hand: way_m * (SIDES[hand] if body.chance(0.8) else 1, 1, 1) for hand in hands}
    twist_rad = body.uniform(-0.3, 0.3) if body.chance(0.3) else 0.0
    rate_hz = min(body.log_uniform(0.4, 3.0), FASTEST_M_S / amplitude_m)
    sine = FreePose(np.zeros((2, 3)), twist_rad=twist_rad).with_hands(moved)
    body.repeat(sine, np.zeros(13), rate_hz, body.rng.integers(1, 8) / rate_hz)


def circles(body: FreeBody) -> None:
    """Move the hands in circles about some places."""
    hands = _hands(body)
    body.reach(body.pose.with_hands(_places(body, hands, body.anywhere)), body.log_uniform(0.6, 3.0))
    plane = body.log_uniform(0.08, 0.45) * np.linalg.qr(body.rng.normal(size=(3, 3)))[0][:2]
    sine, cosine = (
        FreePose(np.zeros((2, 3))).with_hands({hand: axis * (SIDES[hand], 1, 1) for hand in hands}) for axis in plane
    )
    rate_hz = body.log_uniform(0.3, 1.5)
    body.repeat(sine, cosine.values(), rate_hz, body.rng.integers(1, 5) / rate_hz)


def kicks(body: FreeBody) -> None:
    """Swing one leg forward, perhaps from behind, once or twice."""
    leg, standing = int(body.rng.integers(2)), body.pose
    lean_rad = np.deg2rad(body.uniform(-20, 5))
    swung = replace(_with_leg(standing, leg, body.uniform(15, 95), body.uniform(0, 70)), lean_rad=lean_rad)
    if body.chance(0.4):
        body.move(_with_leg(standing, leg, -body.uniform(10, 40), body.uniform(20, 80)), body.uniform(0.2, 0.5))
    for _ in range(body.rng.integers(1, 3)):
        body.move(swung, body.log_uniform(0.2, 0.8))
        body.move(standing, body.log_uniform(0.25, 0.9))


def steps(body: FreeBody) -> None:
    """Walk, march or run on the spot."""
    swing_deg, bend_deg = body.log_uniform(12, 80), body.log_uniform(20, 100)
    seconds, arm_m, standing = body.log_uniform(0.3, 0.8), body.uniform(0.0, 0.25), body.pose
    hands_m = np.array(BENT_ARMS_M) if body.chance(0.4) else standing.hands_m
    back_deg = 0.4 * swing_deg if swing_deg < 45 else 0.0
    for number in range(body.rng.integers(2, 12)):
        leg = number % 2
        stepping = _with_leg(_with_leg(standing, leg, swing_deg, bend_deg), 1 - leg, -back_deg, 0.0)
        swung_m = hands_m + np.outer((1, -1), (0, 0, arm_m if leg else -arm_m))
        body.move(replace(stepping, hands_m=swung_m), seconds)
    body.move(standing, seconds)


def crouches(body: FreeBody) -> None:
    """Bend the knees, perhaps reaching down, and sometimes move the hands there."""
    bend_deg = body.uniform(20, 85)
    low = _with_legs(body.pose, bend_deg, 2 * bend_deg, body.uniform(5, 60))
    if body.chance(0.6):
        low = low.with_hands({hand: _down(body, hand, -0.45, 0.20) for hand in _hands(body)})
    body.move(low, body.log_uniform(0.5, 2.0))
    body.hold(body.uniform(0.05, 1.5))
    if body.chance(0.3):
        strokes(body)


def sits(body: FreeBody) -> None:
    """Sit down, stay, perhaps do something, and stand up."""
    standing, thigh_deg, knee_deg = body.pose, body.uniform(70, 92), body.uniform(70, 100)
    halfway = _with_legs(standing, thigh_deg / 2, knee_deg / 2, body.uniform(20, 45))
    body.move(halfway, body.log_uniform(0.5, 1.2))
    seated = _with_legs(standing, thigh_deg, knee_deg, body.uniform(-10, 15))
    if body.chance(0.7):
        lap = {
            hand: _aside(hand, (body.uniform(0.05, 0.2), body.uniform(0, 0.15), body.uniform(0.15, 0.4)))
            for hand in BOTH
        }
        seated = seated.with_hands(lap)
    body.move(seated, body.log_uniform(0.4, 1.0))
    body.hold(body.uniform(0.2, 3.0))
    for _ in range(body.rng.integers(0, 3)):
        (strokes, touches, swings)[body.rng.integers(3)](body)
        body.hold(body.uniform(0.2, 2.0))
    body.move(replace(halfway, hands_m=body.pose.hands_m), body.log_uniform(0.5, 1.2))


def bows(body: FreeBody) -> None:
    """Lean forward, perhaps reaching down."""
    bowed = replace(body.pose, lean_rad=np.deg2rad(body.uniform(25, 95)))
    if body.chance(0.6):
        bowed = bowed.with_hands({hand: _down(body, hand, -0.6, 0.1) for hand in _hands(body)})
    body.move(bowed, body.log_uniform(0.5, 2.0))
    body.hold(body.uniform(0.05, 1.5))


def turns(body: FreeBody) -> None:
    """Turn the trunk, and sometimes the hips, to and fro."""
    for _ in range(body.rng.integers(1, 5)):
        turn_deg = body.uniform(-60, 60) if body.chance(0.5) else 0.0
        turned = replace(body.pose, twist_rad=np.deg2rad(body.uniform(-60, 60)), turn_rad=np.deg2rad(turn_deg))
        body.move(turned, body.log_uniform(0.4, 1.5))


def touches(body: FreeBody) -> None:
    """Bring the hands to the body and keep them there, as in phoning, drinking or folding the arms; or scratch."""
    hands = _hands(body)
    body.reach(body.pose.with_hands(_places(body, hands, body.on_body)), body.log_uniform(0.6, 2.0))
    body.hold(body.log_uniform(0.3, 5.0))
    if body.chance(0.4):
        scratched = {hand: body.rng.normal(0.0, 0.015, 3) for hand in hands}
        sine = FreePose(np.zeros((2, 3))).with_hands(scratched)
        body.repeat(sine, np.zeros(13), body.uniform(1.5, 4.0), body.uniform(0.5, 2.5))


PHRASES: dict[Callable[[FreeBody], None], int] = {
    strokes: 4, swings: 3, circles: 2, kicks: 2, steps: 2, crouches: 1, sits: 1, bows: 1, turns: 1, touches: 3,
}  # fmt: skip
"""All phrases, and how often each comes in relation to the others, on average over people."""


def _hands(body: FreeBody) -> tuple[int, ...]:
    drawn, acting = body.rng.random(), body.actor.column
    if drawn < BOTH_HANDS:
        return BOTH
    return (acting,) if drawn < BOTH_HANDS + ACTING_HAND else (1 - acting,)


def _places(body: FreeBody, hands: tuple[int, ...], draw: Callable[[int], Array]) -> dict[int, Array]:
    """Draw a place (3,) for each hand, for two of them often places that mirror each other."""
    if len(hands) == 2 and body.chance(ALIKE):
        place_m = draw(0)
        return {0: place_m, 1: place_m * (-1, 1, 1)}
    return {hand: draw(hand) for hand in hands}


def _with_trunk(body: FreeBody, pose: FreePose) -> FreePose:
    """Return the pose with the trunk twisted, leant or turned as well, each in some cases."""
    changes = {
        "twist_rad": (0.4, -50.0, 50.0),
        "lean_rad": (0.3, -10.0, 35.0),
        "turn_rad": (0.15, -40.0, 40.0),
    }
    drawn = {
        name: np.deg2rad(body.uniform(low, high)) for name, (share, low, high) in changes.items() if body.chance(share)
    }
    return replace(pose, **drawn)


def _with_leg(pose: FreePose, leg: int, swing_deg: float, bend_deg: float) -> FreePose:
    legs_rad = pose.legs_rad.copy()
    legs_rad[leg] = np.deg2rad((swing_deg, bend_deg))
    return replace(pose, legs_rad=legs_rad)


def _with_legs(pose: FreePose, swing_deg: float, bend_deg: float, lean_deg: float) -> FreePose:
    both = _with_leg(_with_leg(pose, 0, swing_deg, bend_deg), 1, swing_deg, bend_deg)
    return replace(both, lean_rad=np.deg2rad(lean_deg))


def _down(body: FreeBody, hand: int, lowest_m: float, highest_m: float) -> Array:
    """Draw a place (3,) before the legs."""
    return _aside(hand, (body.uniform(-0.1, 0.28), body.uniform(lowest_m, highest_m), body.uniform(0.2, 0.6)))


def _aside(hand: int, outward_up_forward_m: tuple[float, float, float]) -> Array:
    outward_m, up_m, forward_m = outward_up_forward_m
    return np.array([SIDES[hand] * outward_m, up_m, forward_m])
