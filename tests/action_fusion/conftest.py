import pytest

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings


@pytest.fixture
def node() -> ActionFusion:
    return ActionFusion(Settings())
