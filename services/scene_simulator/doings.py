"""Everyday doings: what people do between actions, each as key poses that begin and end wherever the hands are."""

from collections.abc import Callable

import numpy as np

from actum.arrays import Array
from scene_simulator.hand_doings import (
    BELLY,
    HIP,
    adjust_clothing,
    drink,
    fold_arms,
    gesture,
    phone,
    rub_nose,
    scratch_arm,
    scratch_head,
    stretch,
    wipe_hands,
)
from scene_simulator.motion import HANGING, LEFT, RIGHT, UP, Motion

CLEAR_M = 0.19
"""Least distance of a half action from any object's middle: a grasping hand comes to 0.10 m, and an arc takes 4 cm."""
OUT_OF_VIEW_M = (0.4, 0.8)
"""Way beyond the edge of the view of a person who goes away."""
BACKWARDS_M = (0.0, 0.3)
"""Way backwards, away from the table, of a person who goes away."""


def shift_weight(motion: Motion) -> None:
    """Stand, and put the weight on one leg, then on the other."""
    for _ in range(motion.rng.integers(1, 4)):
        aside, ahead = motion.either_side(0.015, 0.05), motion.uniform(-0.015, 0.015)
        lean, twist = np.deg2rad(motion.uniform(-2, 3)), np.deg2rad(motion.uniform(-5, 5))
        motion.move(shift_m=np.array([aside, ahead]), lean_rad=lean, twist_rad=twist, haste=0.6)
        motion.hold(1.0, 4.0)


def fidget(motion: Motion) -> None:
    """Move the hands about on the table's edge, and tap."""
    motion.to_rest()
    for _ in range(motion.rng.integers(2, 6)):
        hand = motion.one_hand()
        offset = (motion.uniform(-0.10, 0.10), motion.uniform(0.0, 0.04), motion.uniform(-0.03, 0.04))
        motion.move({hand: motion.rest[hand] + offset}, reaching=1.0)
        if motion.rng.random() < 0.3:
            motion.beat({hand: 0.012 * UP}, hz=(2.0, 4.0), seconds=(0.8, 2.0))
        motion.hold(0.2, 1.2)


def look_around(motion: Motion) -> None:
    """Turn the trunk, and sometimes the hips, to one side and perhaps to the other."""
    side = 1.0
    for _ in range(motion.rng.integers(1, 4)):
        side = -side if motion.rng.random() < 0.7 else side
        twist, turn = side * np.deg2rad(motion.sized(15, 45)), side * np.deg2rad(motion.uniform(0, 20))
        motion.move(twist_rad=twist, turn_rad=turn, lean_rad=np.deg2rad(motion.uniform(-3, 6)))
        motion.hold(0.4, 2.0)


def walk_away(motion: Motion) -> None:
    """Go out of view to the nearer side, and come back after a while."""
    _let_hang(motion)
    edge_m = motion.edge_of_view()
    beyond_m = np.sign(edge_m) * motion.uniform(*OUT_OF_VIEW_M)
    way = np.array([edge_m + beyond_m, 0.0, motion.uniform(*BACKWARDS_M)])
    _walk(motion, motion.from_camera(motion.layout.pelvis_m + way))
    motion.hold(2.0, 12.0)
    _walk(motion, np.zeros(3))


def pace(motion: Motion) -> None:
    """Walk a few steps to and fro, within view."""
    _let_hang(motion)
    for _ in range(motion.rng.integers(1, 4)):
        aside, behind = motion.either_side(0.3, 0.7), motion.uniform(0.0, 0.4)
        _walk(motion, np.array([aside, 0.0, -behind]))
        motion.hold(0.2, 1.5)
    _walk(motion, np.zeros(3))


def half_reach(motion: Motion) -> None:
    """Reach for an object, and draw the hand back before it is there."""
    hand = _towards_an_object(motion)
    if motion.rng.random() < 0.5:
        motion.hold(0.05, 0.8)
    motion.move({hand: motion.rest[hand]}, reaching=1.0)


def half_lift(motion: Motion) -> None:
    """Reach as if to lift an object, raise the empty hand before it a little, and let it be."""
    hand = _towards_an_object(motion)
    motion.move({hand: motion.last.hands_m[hand] + motion.sized(0.03, 0.09) * UP}, reaching=1.0)
    motion.hold(0.05, 0.5)
    motion.move({hand: motion.rest[hand]}, reaching=1.0)


KINDS: dict[str, Callable[[Motion], None]] = {
    doing.__name__: doing
    for doing in (
        shift_weight,
        fidget,
        look_around,
        walk_away,
        pace,
        scratch_head,
        scratch_arm,
        rub_nose,
        drink,
        phone,
        stretch,
        fold_arms,
        adjust_clothing,
        gesture,
        wipe_hands,
        half_reach,
        half_lift,
    )
}
"""All kinds of everyday doings by their names."""


def stand_at_ease(motion: Motion) -> None:
    """Come to stand as people do between doings: hands on the table, hanging, before the belly, or one at the hip."""
    match motion.rng.choice(4, p=(0.45, 0.30, 0.15, 0.10)):
        case 0:
            motion.to_rest()
        case 1:
            _let_hang(motion)
        case 2:
            motion.straighten({hand: motion.on_body(hand, BELLY) for hand in (LEFT, RIGHT)})
        case _:
            hand = motion.one_hand()
            motion.straighten({hand: motion.on_body(hand, HIP), 1 - hand: motion.on_body(1 - hand, HANGING)})


def _let_hang(motion: Motion) -> None:
    motion.straighten({hand: motion.on_body(hand, HANGING) for hand in (LEFT, RIGHT)})


def _walk(motion: Motion, goal_m: Array) -> None:
    """Turn towards a goal (3,; leftward, up, forward from where the person stands at the table) and walk to it."""
    shift_m = np.array([goal_m[0], goal_m[2]])
    leftward, forward = shift_m - motion.last.shift_m
    motion.move(turn_rad=float(np.arctan2(leftward, forward)), haste=1.5)
    motion.move(shift_m=shift_m)


def _towards_an_object(motion: Motion) -> int:
    """Reach from the rest towards an object, not as far as it; return the hand's column."""
    motion.to_rest()
    hand = motion.one_hand()
    bodies = motion.objects()
    way = bodies[motion.rng.integers(len(bodies))] + motion.uniform(0.02, 0.10) * UP - motion.rest[hand]
    path = motion.rest[hand] + np.linspace(0, 1, 100)[:, None] * way
    nearest_m = np.linalg.norm(path[:, None] - bodies, axis=2).min(axis=1)
    farthest = np.argmax(nearest_m < CLEAR_M) / 100
    motion.move({hand: motion.rest[hand] + motion.uniform(0.6, 1.0) * farthest * way}, reaching=1.0)
    return hand
