"""What is told of what was found: nothing that is switched off, nothing too soon."""

from actum.node import SECOND_NS
from som_classifier.spotting.search import Admission
from som_classifier.spotting.spotted import SpottingOptions


def fates(options: SpottingOptions, *actions: tuple[str, float, float]) -> list[str]:
    admission = Admission(options)
    ns = [(action, round(start * SECOND_NS), round(end * SECOND_NS)) for action, start, end in actions]
    return [admission.admit(*each) or "told" for each in ns]


def test_where_nothing_is_asked_everything_is_told() -> None:
    assert fates(SpottingOptions(), ("wave", 0, 1), ("wave", 1, 2), ("clap", 2.0, 2.1)) == ["told"] * 3


def test_what_is_switched_off_is_not_told_and_hinders_nothing_after_it() -> None:
    options = SpottingOptions(disabled=frozenset({"wave"}), shortest_pause_s=1.0)
    assert fates(options, ("wave", 0, 1), ("clap", 1.5, 2), ("wave", 2.1, 3)) == ["disabled", "told", "disabled"]


def test_what_begins_before_the_shortest_pause_is_over_belongs_to_the_one_before() -> None:
    options = SpottingOptions(shortest_pause_s=0.5)
    stirring = [("stir", 0, 1), ("stir", 1.2, 2), ("stir", 2.4, 3), ("stir", 3.5, 4)]
    assert fates(options, *stirring) == ["told", "pause", "pause", "told"]


def test_after_one_told_none_of_its_own_is_until_its_cooldown_is_over() -> None:
    options = SpottingOptions(cooldown_s={"wave": 3.0})
    waves = [("wave", s, s + 0.4) for s in (0, 2, 3, 3.5, 6.0)]
    assert fates(options, *waves) == ["told", "cooldown", "cooldown", "told", "cooldown"]
    assert fates(options, ("wave", 0, 1), ("clap", 1, 2), ("clap", 2, 3)) == ["told"] * 3


def test_what_was_done_at_the_same_time_is_told_once() -> None:
    """As two models may find it, one after the other."""
    assert fates(SpottingOptions(), ("wave", 0, 1), ("clap", 0.5, 1.5)) == ["told", "pause"]


def test_a_forecast_says_the_same_and_changes_nothing() -> None:
    admission = Admission(SpottingOptions(shortest_pause_s=0.5, cooldown_s={"wave": 3.0}))
    assert [admission.hindrance("wave", 0), admission.admit("wave", 0, SECOND_NS)] == [None, None]
    soon, later = SECOND_NS + SECOND_NS // 4, 2 * SECOND_NS
    assert [admission.hindrance("wave", ns) for ns in (soon, later)] == ["pause", "cooldown"]
    assert [admission.hindrance("clap", ns) for ns in (soon, later, later)] == ["pause", None, None]
