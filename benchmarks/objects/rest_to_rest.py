"""Actions cut from rest to rest: the segment lasts until the hand is back, and the object may be back by then, too."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from benchmarks.rig.hard_scenes.conditions import Conditions
from benchmarks.rig.hard_scenes.hard_scene import HardScene
from benchmarks.rig.hard_scenes.hard_simulator import HardSimulator

from actum.messages import Action, Message, Truth
from actum.node import SECOND_NS
from scene_simulator.programme import Task
from scene_simulator.timeline import Episode, resetting, still
from scene_simulator.trial import Layout

from .observing import MEASURES, observed, own_displacement, seen_left
from .trials import OURS, Trial
from .unmarked import Unmarked, events_of

Way = Literal["left there", "goes back by itself", "taken back by the hand"]
"""What becomes of the object after the action. By itself it goes back while the hand does, as where actions are taught
in the simulated scene; the hand takes it back on the same way, and leaves it then."""
WAYS: tuple[Way, ...] = get_args(Way)
MARGIN_S = 0.2
"""Rest that a cut has before and after the movement, as `actum_examples.cutting` leaves."""
REST_S = 0.5
"""How long everything rests between the way back and the arrangement of the objects for the next action."""
ARRANGE_S = 1.0
"""How long that takes."""
IMAGE_HZ = 15


class ReturningScene(HardScene):
    """A scene in which the hand comes to rest after each action before the objects are arranged for the next one."""

    way: Way = "left there"

    def pause(self, done: Episode, following: Layout, seconds: float, return_s: float) -> Iterator[Episode]:
        """Yield the way back, a rest, and the arrangement of what follows."""
        assert done.trial is not None
        rests = done.trial.layout
        if self.way == "left there":
            rests = replace(rests, positions_m=done.positions_m[-1], yaw_rad=done.yaw_rad[-1])
        by_hand = self.way == "taken back by the hand"
        back = _backwards(done) if by_hand else resetting(self.parameters, done, rests, return_s, return_s)
        resting = still(self.parameters, rests, REST_S)
        for episode in (back, resting):
            yield replace(episode, riser_tops_m=np.broadcast_to(done.riser_tops_m[-1], episode.riser_tops_m.shape))
        yield resetting(self.parameters, resting, following, max(seconds, ARRANGE_S), ARRANGE_S)

    def way_back_s(self, number: int) -> float:
        """Return how long it takes after the action of a number until the hand is back (s)."""
        trial = self.trials[number]
        by_hand = self.way == "taken back by the hand"
        return trial.timing.duration_s if by_hand else self.parameters.pause.return_share * trial.pause_s


def _backwards(done: Episode) -> Episode:
    """Return an action backwards: the hand takes the object back to where it was, and returns to rest."""
    return replace(
        done,
        segment=None,
        hands_m=done.hands_m[::-1],
        positions_m=done.positions_m[::-1],
        yaw_rad=done.yaw_rad[::-1],
        grip=done.grip[::-1],
        pointing=done.pointing[::-1],
    )


class ReturningSimulator(HardSimulator):
    """A source of such a scene."""

    def __init__(self, programme: Sequence[Task], person: int, conditions: Conditions, way: Way) -> None:
        super().__init__(programme, person, person, conditions, image_hz=IMAGE_HZ, tail_s=ARRANGE_S)
        self.scene: ReturningScene = ReturningScene(programme, person, person, conditions)
        self.scene.way = way


def trials_from_rest_to_rest(programme: Sequence[Task], person: int, conditions: Conditions, way: Way) -> list[Trial]:
    """Draw a scene and judge its actions by bounds from rest to rest; nothing is looked for without marks."""
    simulator = ReturningSimulator(programme, person, conditions, way)
    stream = list(observed(simulator))
    events = events_of(from_rest_to_rest(simulator, stream), MEASURES[OURS])
    ends = [message for message in stream if isinstance(message, Truth) and message.kind == "end"]
    return [
        Trial(
            truth=end,
            displacement_m=own_displacement(simulator, number, end),
            line_right=False,
            seen_left=seen_left(simulator, stream, number, end),
            events={OURS: event},
            unmarked=Unmarked(None, 0, {}),
        )
        for number, (end, event) in enumerate(zip(ends, events, strict=True))
    ]


def from_rest_to_rest(simulator: ReturningSimulator, stream: Sequence[Message]) -> list[Message]:
    """Move the bounds of the actions of a stream to the rest before and after each."""
    actions = [message for message in stream if isinstance(message, Action)]
    moved = [_from_rest_to_rest(action, simulator.scene.way_back_s(n)) for n, action in enumerate(actions)]
    others = [message for message in stream if not isinstance(message, Action)]
    return sorted([*others, *moved], key=lambda message: message.stamp_ns)


def _from_rest_to_rest(action: Action, way_back_s: float) -> Action:
    assert action.end_ns is not None
    start_ns = action.start_ns - round(MARGIN_S * SECOND_NS)
    end_ns = action.end_ns + round((way_back_s + MARGIN_S) * SECOND_NS)
    return action.model_copy(update={"stamp_ns": end_ns, "start_ns": start_ns, "end_ns": end_ns})
