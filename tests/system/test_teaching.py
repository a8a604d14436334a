"""Teaching by real queries to real processes, a kill at any moment, and a classifier that takes the model."""

import subprocess
import sys
from pathlib import Path

import pytest

from live import System

EXAMPLE = Path(__file__).parents[2] / "examples" / "teach_by_queries.py"
pytestmark = pytest.mark.system


@pytest.mark.timeout(240)
def test_three_actions_are_taught_and_recognised_by_queries_alone(running: System) -> None:
    running.start_router()
    model = running.folder / "in-use.npz"
    for name in ("pose_preprocessor", "action_fusion"):
        running.start(name)
    running.start("som_classifier", "--model", str(model))
    running.start("actum_model_trainer", "--model", str(model))
    running.start("scene_simulator", "--driven", "--image-hz", "0")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "action_fusion", "som_classifier", "model_trainer")
        running.wait_for_services(client, "sensor_gateway")
    done = subprocess.run(
        [sys.executable, str(EXAMPLE), running.settings.connect, running.settings.sensor],
        env={"PATH": "/usr/bin"},
        capture_output=True,
        text=True,
        timeout=220,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.splitlines()
    assert lines.count("  5 of 5") == 3
    assert [line for line in lines if line.startswith("recognised")] == [
        "recognised: lift",
        "recognised: push",
        "recognised: put",
    ]
