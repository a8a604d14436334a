"""Everyday doings: what people do between actions, each as key poses that begin and end wherever the hands are."""

from collections.abc import Callable

import numpy as np

from actum.arrays import Array
from scene_simulator.motion import HANGING, LEFT, RIGHT, SIDES, Motion

# Places on the body: outward to the hand's side, up from the pelvis, forward, in shares of stature.
CROWN = (0.030, 0.475, 0.030)
NAPE = (0.045, 0.400, -0.045)
EAR = (0.070, 0.400, 0.030)
NOSE = (0.010, 0.390, 0.085)
MOUTH = (0.015, 0.365, 0.120)
COLLAR = (0.060, 0.270, 0.080)
HEM = (0.085, 0.020, 0.100)
POCKET = (0.120, -0.015, 0.065)
HIP = (0.125, 0.035, 0.010)
BELLY = (0.025, 0.060, 0.115)
OVERHEAD = (0.090, 0.585, 0.020)
WIDE = (0.380, 0.290, 0.020)
OTHER_ELBOW = (-0.080, 0.175, 0.105)
OTHER_UPPER_ARM = (-0.110, 0.215, 0.080)
HELD_FOREARM = (0.020, 0.120, 0.150)
OVER_FOREARM = (-0.020, 0.135, 0.170)
BEFORE_BELLY = (0.025, 0.120, 0.165)

UP = np.array([0.0, 1.0, 0.0])
CLEAR_M = 0.19
"""Least distance of a half action from any object's middle: a grasping hand comes to 0.10 m, and an arc takes 4 cm."""
GLASS_ASIDE_M = (0.36, 0.46)
"""Distance of the glass to the hand's side of the person, beside the marked objects."""
GLASS_INSET_M = (0.10, 0.18)
"""Distance of the glass from the table's edge."""
GLASS_GRASP_M = 0.07
"""Height of the palm above the table at the glass."""
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


def scratch_head(motion: Motion) -> None:
    """Scratch the crown or the nape."""
    hand = motion.one_hand()
    place, along = [(CROWN, (0.6, 0.2, 0.8)), (NAPE, (0.4, 1.0, 0.2))][motion.rng.integers(2)]
    lean = np.deg2rad(motion.uniform(-1, 6))
    motion.move({hand: motion.on_body(hand, place, lean_rad=lean)}, lean_rad=lean)
    _scratch(motion, hand, np.array(along))


def rub_nose(motion: Motion) -> None:
    """Rub the nose, or rest the hand at it for a moment."""
    hand = motion.one_hand()
    motion.move({hand: motion.on_body(hand, NOSE)}, haste=1.1)
    if motion.rng.random() < 0.7:
        motion.beat({hand: np.array([0.015, 0.004, 0.0])}, hz=(2.0, 4.0), seconds=(0.4, 1.5))
    else:
        motion.hold(0.3, 1.2)


def scratch_arm(motion: Motion) -> None:
    """Scratch the other upper arm, or the other forearm held before the body."""
    hand = motion.one_hand()
    if motion.rng.random() < 0.5:
        motion.move({hand: motion.on_body(hand, OTHER_UPPER_ARM)})
        return _scratch(motion, hand, np.array([0.2, 1.0, 0.2]))
    other = 1 - hand
    motion.move({hand: motion.on_body(hand, OVER_FOREARM), other: motion.on_body(other, HELD_FOREARM)})
    return _scratch(motion, hand, np.array([0.7, 0.2, 1.0]))


def drink(motion: Motion) -> None:
    """Take a glass that carries no marker from the table, drink, and put it back."""
    hand, table = motion.one_hand(), motion.parameters.table
    x = motion.layout.pelvis_m[0] + SIDES[hand] * motion.uniform(*GLASS_ASIDE_M)
    z = table.far_z_m - motion.uniform(*GLASS_INSET_M)
    glass = motion.from_camera(np.array([x, motion.parameters.table_y_m - GLASS_GRASP_M, z]))
    motion.move({hand: glass}, lean_rad=np.deg2rad(4.0))
    motion.hold(0.1, 0.3)
    for _ in range(motion.rng.integers(1, 3)):
        motion.move({hand: motion.on_body(hand, MOUTH, lean_rad=-0.05)}, lean_rad=-0.05)
        motion.hold(0.6, 2.5)
        motion.move({hand: motion.on_body(hand, OVER_FOREARM)}, lean_rad=0.0)
        motion.hold(0.2, 3.0)
    motion.move({hand: glass}, lean_rad=np.deg2rad(4.0))
    motion.hold(0.1, 0.3)


def phone(motion: Motion) -> None:
    """Take a phone from the pocket, hold it to the ear and talk, and put it back."""
    hand = motion.one_hand()
    motion.move({hand: motion.on_body(hand, POCKET)})
    motion.hold(0.3, 1.0)
    if motion.rng.random() < 0.6:
        motion.move({hand: motion.on_body(hand, BEFORE_BELLY)})
        motion.hold(0.5, 2.0)
    for _ in range(motion.rng.integers(1, 5)):
        twist, lean = np.deg2rad(motion.uniform(-15, 15)), np.deg2rad(motion.uniform(-2, 5))
        ear = motion.on_body(hand, EAR, twist, lean)
        motion.move({hand: ear}, twist_rad=twist, lean_rad=lean)
        motion.hold(1.0, 4.0)
    motion.move({hand: motion.on_body(hand, POCKET)}, twist_rad=0.0, lean_rad=0.0)
    motion.hold(0.3, 0.8)


def stretch(motion: Motion) -> None:
    """Stretch both arms upward or sideways, leaning back."""
    place, lean = (OVERHEAD, WIDE)[motion.rng.integers(2)], -np.deg2rad(motion.sized(3, 9))
    motion.move({hand: motion.on_body(hand, COLLAR) for hand in (LEFT, RIGHT)})
    motion.move({hand: motion.on_body(hand, place, lean_rad=lean) for hand in (LEFT, RIGHT)}, haste=0.8, lean_rad=lean)
    motion.hold(0.8, 2.5)


def fold_arms(motion: Motion) -> None:
    """Fold the arms and stand so."""
    hand = motion.one_hand()
    inner, outer = motion.on_body(hand, OTHER_ELBOW), motion.on_body(1 - hand, OTHER_ELBOW)
    motion.move({hand: inner, 1 - hand: outer + np.array([0.0, -0.05, 0.05])})
    motion.hold(2.0, 8.0)


def adjust_clothing(motion: Motion) -> None:
    """Pull down the hem, set the collar right, or pull up a sleeve."""
    hand = motion.one_hand()
    match motion.rng.integers(3):
        case 0:
            motion.move({hand: motion.on_body(hand, BELLY), 1 - hand: motion.on_body(1 - hand, BELLY)})
            motion.move({hand: motion.on_body(hand, HEM), 1 - hand: motion.on_body(1 - hand, HEM)})
        case 1:
            motion.move({hand: motion.on_body(hand, COLLAR), 1 - hand: motion.on_body(1 - hand, COLLAR)})
            tug = np.array([0.02, 0.02, 0.0])
            motion.beat({hand: tug, 1 - hand: -tug}, hz=(1.0, 2.0), seconds=(0.8, 2.0))
        case _:
            motion.move({hand: motion.on_body(hand, OVER_FOREARM), 1 - hand: motion.on_body(1 - hand, HELD_FOREARM)})
            motion.move({hand: motion.on_body(hand, OTHER_ELBOW)})
    motion.hold(0.2, 0.8)


def gesture(motion: Motion) -> None:
    """Talk with one hand or with both: strokes to changing places before the body, some just above the table."""
    hands = (LEFT, RIGHT) if motion.rng.random() < 0.5 else (motion.one_hand(),)
    for _ in range(motion.rng.integers(4, 12)):
        places = {hand: motion.on_body(hand, _before_the_body(motion)) for hand in hands}
        twist, lean = np.deg2rad(motion.uniform(-8, 8)), np.deg2rad(motion.uniform(-2, 4))
        motion.move(places, haste=motion.uniform(0.9, 1.6), twist_rad=twist, lean_rad=lean)
        if motion.rng.random() < 0.3:
            motion.beat(dict.fromkeys(hands, 0.03 * UP), hz=(1.0, 2.0), seconds=(0.6, 1.5))
        motion.hold(0.05, 0.8)


def wipe_hands(motion: Motion) -> None:
    """Rub the hands on each other, or on the trousers."""
    rubbed = motion.rng.random() < 0.6
    place, along = (BEFORE_BELLY, (0.0, 0.02, 0.035)) if rubbed else (POCKET, (0.0, 0.05, 0.02))
    motion.move({LEFT: motion.on_body(LEFT, place), RIGHT: motion.on_body(RIGHT, place)})
    amplitude = np.array(along)
    beats_m = {LEFT: amplitude, RIGHT: -amplitude if rubbed else amplitude}
    motion.beat(beats_m, hz=(1.5, 3.0), seconds=(1.0, 4.0))


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


def _scratch(motion: Motion, hand: int, along: Array) -> None:
    amplitude = motion.uniform(0.010, 0.022) * along
    motion.beat({hand: amplitude * (SIDES[hand], 1, 1)}, hz=(3.0, 4.5), seconds=(0.8, 3.0))


def _before_the_body(motion: Motion) -> tuple[float, float, float]:
    return motion.uniform(0.02, 0.19), motion.uniform(0.04, 0.26), motion.uniform(0.13, 0.20)


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
