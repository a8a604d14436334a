"""The example mapping, and the layouts for RViz and Foxglove, fit the simulated scene and the bridge's topics."""

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from ros2_bridge.hri_out.mapping import load
from ros2_bridge.settings import Settings
from ros2_bridge.topics import node
from scene_simulator.programme import ACTIONS

EXAMPLES = Path(__file__).parents[2] / "examples"
TOPICS = {"/" + "/".join(topic.key.split("/")[1:-2]) for topic in node(Settings(), "5e55").publishes}
LEVEL = f"{Settings().sensor}_level"


def values(part: Any, key: str) -> list[Any]:
    """All values of a key, however deep."""
    if isinstance(part, dict):
        return [found for name, each in part.items() for found in ([each] if name == key else values(each, key))]
    return [found for each in part for found in values(each, key)] if isinstance(part, list) else []


def test_the_mapping_calls_an_action_of_the_simulated_scene_an_intent() -> None:
    mapping = load(EXAMPLES / "ros4hri.yaml")
    assert {*ACTIONS} & mapping.intents.keys() == {"point"}
    assert mapping.gestures


def test_rviz_shows_topics_and_frames_that_there_are() -> None:
    layout = yaml.safe_load((EXAMPLES / "ros4hri.rviz").read_text(encoding="utf-8"))
    shown = {topic["Value"] for topic in values(layout, "Topic")}
    assert shown
    assert shown <= TOPICS
    assert values(layout, "Fixed Frame") == [LEVEL]


def test_foxglove_shows_topics_and_frames_that_there_are() -> None:
    layout = json.loads((EXAMPLES / "ros4hri.foxglove.json").read_text(encoding="utf-8"))
    shown = {*values(layout, "topicPath"), *layout["configById"]["3D!people"]["topics"]}
    assert len(shown) == 4
    assert shown <= TOPICS
    assert {*values(layout, "followTf"), *values(layout, "frameId")} == {LEVEL}
    placed = {panel for key in ("first", "second") for panel in values(layout["layout"], key) if isinstance(panel, str)}
    assert "3D!people" in placed
    assert placed <= layout["configById"].keys()
