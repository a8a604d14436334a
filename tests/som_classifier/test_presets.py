"""The paper's architecture as printed, and schedules that fit their maps."""

from som_classifier.presets import DEFAULT, PAPER, PRESETS, PYRAMID


def test_presets_are_found_by_their_names() -> None:
    assert {name: preset.name for name, preset in PRESETS.items()} == {"paper": "paper", "pyramid": "pyramid"}
    assert PRESETS["paper"] is PAPER
    assert PRESETS["pyramid"] is PYRAMID is DEFAULT


def test_the_papers_sizes() -> None:
    assert (PAPER.layer1.rows, PAPER.layer1.cols) == (30, 30)
    assert (PAPER.layer2.rows, PAPER.layer2.cols) == (35, 35)
    assert PAPER.beta == 0.35
    assert PAPER.posture.attention == "moving"


def test_every_radius_of_the_papers_falls_from_half_the_grid_to_a_few_units() -> None:
    for plan in (PAPER.layer1, PAPER.layer2):
        _, radius = plan.schedule.values(plan.steps)
        assert radius[0] == max(plan.rows, plan.cols) / 2
        assert 0.5 <= radius[-1] <= 3.0
        assert (radius[1:] < radius[:-1]).all()


def test_every_radius_of_the_defaults_falls_from_a_third_of_the_grid_to_the_nearest_neighbours() -> None:
    for grid, (first, last) in ((PYRAMID.units, PYRAMID.unit_radius), (PYRAMID.concepts, PYRAMID.concept_radius)):
        assert max(grid) / 3 <= first <= max(grid) / 2
        assert 0.5 <= last <= 2.0


def test_the_defaults_stages_go_on_to_the_complete_action() -> None:
    for stage in PYRAMID.stages:
        assert list(stage) == sorted(set(stage))
    assert list(PYRAMID.stages) == sorted(PYRAMID.stages)
    assert PYRAMID.stages[0][0] > 0
    assert PYRAMID.stages[-1] == (1.0,)
