"""How uncertain a person's distance is goes with them."""

import pytest

from actum.messages import Posture
from people import STANDING, skeleton
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings


@pytest.mark.parametrize("std_m", [0.15, None])
def test_a_posture_says_what_its_skeleton_said(std_m: float | None) -> None:
    frame = skeleton(5, STANDING)
    told = frame.model_copy(update={"agents": [frame.agents[0].model_copy(update={"depth_std_m": std_m})]})
    [posture] = PosePreprocessor(PoseSettings.defaults()).handle(told)
    assert isinstance(posture, Posture)
    assert posture.depth_std_m == std_m
