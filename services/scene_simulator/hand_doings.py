"""Everyday doings of the hands on the body, before it, and with a glass or a phone."""

import numpy as np

from actum.arrays import Array
from scene_simulator.motion import LEFT, RIGHT, SIDES, UP, Motion

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

GLASS_ASIDE_M = (0.36, 0.46)
"""Distance of the glass to the hand's side of the person, beside the marked objects."""
GLASS_INSET_M = (0.10, 0.18)
"""Distance of the glass from the table's edge."""
GLASS_GRASP_M = 0.07
"""Height of the palm above the table at the glass."""


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
        places = {
            hand: motion.on_body(
                hand, (motion.uniform(0.02, 0.19), motion.uniform(0.04, 0.26), motion.uniform(0.13, 0.20))
            )
            for hand in hands
        }
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


def _scratch(motion: Motion, hand: int, along: Array) -> None:
    amplitude = motion.uniform(0.010, 0.022) * along
    motion.beat({hand: amplitude * (SIDES[hand], 1, 1)}, hz=(3.0, 4.5), seconds=(0.8, 3.0))
