"""The paper's architecture as printed, and schedules that fit their maps."""

import pytest

from som_classifier.presets import PAPER, PRESETS, Preset


def test_the_papers_sizes() -> None:
    assert (PAPER.layer1.rows, PAPER.layer1.cols) == (30, 30)
    assert (PAPER.layer2.rows, PAPER.layer2.cols) == (35, 35)
    assert PAPER.beta == 0.35
    assert PAPER.part is None


@pytest.mark.parametrize("preset", PRESETS.values(), ids=list(PRESETS))
def test_every_radius_falls_from_half_the_grid_to_the_nearest_neighbours(preset: Preset) -> None:
    assert PRESETS[preset.name] is preset
    for plan in (preset.layer1, preset.layer2):
        _, radius = plan.schedule.values(plan.steps)
        assert radius[0] == max(plan.rows, plan.cols) / 2
        assert 0.5 <= radius[-1] <= 2.0
        assert (radius[1:] < radius[:-1]).all()
