"""A short run of `make chaos`: whatever befalls services and routers, each mark has its one answer."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.system, pytest.mark.chaos, pytest.mark.timeout(400)]


def test_every_marked_segment_has_one_answer_right_or_rejected_for_a_true_reason(
    scene_model: Path, tmp_path: Path
) -> None:
    asked = ["--seed", "4", "--faults", "8", "--segments", "8", "--model", str(scene_model), "--folder", str(tmp_path)]
    run = subprocess.run(
        [sys.executable, "-m", "benchmarks.chaos", *asked],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        check=False,
    )
    print(run.stdout)
    assert run.returncode == 0, run.stdout + run.stderr
