"""Scenes from rest to rest: after an action and the way back, nothing moves before the objects are arranged anew."""

import numpy as np
import pytest
from benchmarks.objects.rest_to_rest import REST_S, WAYS, ReturningSimulator, Way
from benchmarks.rig.hard_scenes.conditions import PLAIN

from scene_simulator.programme import Task

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("way", WAYS)
def test_all_objects_rest_after_the_way_back(way: Way) -> None:
    scene = ReturningSimulator([Task("push", 1), Task("lift", 2)], 3, PLAIN, way).scene
    states, rate_hz = list(scene.states()), scene.parameters.camera.frame_rate_hz
    for number in range(2):
        end = max(state.frame for state in states if state.segment == number)
        first = end + round(scene.way_back_s(number) * rate_hz) + 2
        resting = np.array([state.positions_m for state in states[first : first + round(REST_S * rate_hz) - 3]])
        assert np.ptp(resting, axis=0).max() < 1e-9
