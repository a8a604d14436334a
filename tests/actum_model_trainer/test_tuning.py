"""The settings of the search are picked from labelled continuous recordings, by what the classifier would tell."""

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import NoSpotterError, found_by
from actum_model_trainer.tuning import tuning
from actum_model_trainer.tuning.choosing import Choice, chosen, held_out
from actum_model_trainer.tuning.doubts import rate_bounds
from actum_model_trainer.tuning.sensitivities import plainest, sensitivities
from actum_model_trainer.tuning.trials import Trial, tried
from actum_model_trainer.tuning.tuning import NothingLabelledError, tuned
from actum_model_trainer.tuning.tuning_report import tuning_report
from actum_model_trainer.tuning.weighing import Weighed
from days import days, fidgeting, searching_model
from people import FRAME_NS, skeleton
from performers import HAND_PATHS, performance
from recognisers import tiny_model
from som_classifier.model import Model
from som_classifier.pyramid_model import PyramidModel
from som_classifier.segmentation import Segmentation
from som_classifier.spotting.spotted import SpottingOptions

Record = Callable[..., Recording]


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[Recording]:
    return days(tmp_path_factory.mktemp("days"))


@pytest.fixture(scope="module")
def model(recordings: list[Recording]) -> Model:
    return searching_model(recordings[:2])


def test_each_sensitivity_is_one_threshold_of_the_model_and_can_be_asked_for(model: Model) -> None:
    assert sensitivities(model) == [None, 4.0, 2.0, 1.0]
    assert model.spotting is not None
    assert [model.spotting.threshold_for(rate) for rate in sensitivities(model)] == [0.02, 0.2, 0.3, 0.8]


def test_a_model_without_background_has_one_sensitivity(model: Model) -> None:
    assert isinstance(model, PyramidModel) and model.spotting is not None
    none = model.spotting.model_copy(update={"false_alarms_per_min": []})
    assert sensitivities(replace(model, metadata=model.metadata.model_copy(update={"spotting": none}))) == [None]


@pytest.mark.parametrize(
    ("least", "below", "expected"),
    [
        (0.31, 0.52, 0.4),
        (0.31, 0.39, 0.31),
        (0.312, 0.39, 0.32),
        (2.4, 9.0, 3.0),
        (0.0, 0.5, 0.1),
        (0.0, 0.05, 0.01),
        (1.0, 1.5, 1.0),
    ],
)
def test_a_sensitivity_is_named_by_the_plainest_number(least: float, below: float, expected: float) -> None:
    assert plainest(least, below) == expected


@pytest.fixture(scope="module")
def trial(model: Model, recordings: list[Recording]) -> Trial:
    (made,) = tried(model, recordings[2:])
    return made


def test_the_sensitivities_find_different_numbers_of_actions(model: Model, recordings: list[Recording]) -> None:
    """Before the verifier, which drops here what the less sensitive ones do not find."""
    assert isinstance(model, PyramidModel)
    taking_all = replace(model, verifier=replace(model.verifier, least_likeness=-1e9, least_found_likeness=-1e9))
    (trial,) = tried(taking_all, recordings[2:])
    assert len({len(trial.found(SpottingOptions(sensitivity)).detections) for sensitivity in trial.searched}) > 1


@pytest.mark.parametrize(
    "options",
    [
        SpottingOptions(),
        *(pytest.param(SpottingOptions(rate), marks=pytest.mark.thorough) for rate in (4.0, 2.0, 1.0)),
        SpottingOptions(shortest_pause_s=0.3),
        SpottingOptions(2.0, cooldown_s={"lift": 3.0, "push": 1.0}),
        SpottingOptions(4.0, disabled=frozenset({"lift"})),
    ],
)
def test_all_sensitivities_at_once_find_what_the_classifier_finds_with_each(
    model: Model, recordings: list[Recording], trial: Trial, options: SpottingOptions
) -> None:
    assert options.false_alarms_per_min in trial.searched
    assert Found() + trial.found(options) == found_by(model, recordings[2:], segmentation=Segmentation(options=options))


def test_people_who_leave_and_clocks_that_begin_anew_make_no_difference(model: Model, record: Record) -> None:
    there, marks = performance([*HAND_PATHS] * 2)
    away = [skeleton((len(there) + i) * FRAME_NS) for i in range(60)]
    back = [skeleton((len(there) + 60 + i) * FRAME_NS, joints(each)) for i, each in enumerate(there)]
    anew = [each.model_copy(update={"session_id": "another"}) for each in there]
    broken = record("broken", *there, *away, *back, *anew, *marks)
    (trial,) = tried(model, [broken])
    assert Found() + trial.found(SpottingOptions()) == found_by(model, [broken])


def joints(frame: Skeleton) -> np.ndarray:
    return np.array(frame.agents[0].joints)


def test_a_model_without_a_search_is_refused(recordings: list[Recording]) -> None:
    with pytest.raises(NoSpotterError, match="train it again"):
        tuned(tiny_model(), recordings)


@pytest.mark.thorough
def test_the_scores_told_are_those_of_the_classifier_with_the_settings_picked(
    model: Model, recordings: list[Recording]
) -> None:
    result = tuned(model, recordings[2:])
    found = found_by(model, recordings[2:], segmentation=Segmentation(options=result.best.options))
    assert result.best.scores == scores_of(found)
    assert result.best in result.outcomes
    assert result.untuned == scores_of(found_by(model, recordings[2:]))
    assert result.best.scores.event.f1 >= result.untuned.event.f1
    assert tuning.OTHERWISE not in result.doubts


def test_recordings_without_a_label_are_refused(model: Model, record: Record) -> None:
    with pytest.raises(NothingLabelledError, match="no labelled action"):
        tuned(model, [record("bare", *fidgeting(60, 0))])


def test_what_speaks_against_the_choice_is_said(model: Model, recordings: list[Recording], record: Record) -> None:
    said = " ".join(tuned(model, recordings[:1]).doubts)
    assert "trained on person 1" in said
    assert "only 6 actions" in said
    assert "min of background are too short to tell whether there are more than 1 false alarms a minute" in said
    skeletons, _ = performance(["lift"])
    marks = performance(["lift"], frames=25)[1]
    bare = tuned(model, [record("bare", *skeletons, *marks, person="")]).doubts
    assert any("the recordings contain no background" in doubt for doubt in bare)
    assert any("names no person" in doubt for doubt in bare)


def test_only_where_no_settings_have_as_few_false_alarms_as_wanted_that_is_said(
    model: Model, recordings: list[Recording]
) -> None:
    result = tuned(model, recordings[:1])
    noisy = replace(result, best=result.outcomes[0])
    false_per_min = noisy.best.scores.false_per_min
    assert false_per_min is not None and false_per_min > 1.0
    sentence = "no settings have as few as 1 false alarms a minute here: these have the fewest"
    for most_per_min, said in ((None, []), (false_per_min, []), (1.0, [sentence])):
        shown = io.StringIO()
        Console(width=110, file=shown).print(tuning_report(noisy, most_per_min, 0.0))
        assert [line.strip() for line in shown.getvalue().splitlines() if "no settings" in line] == said


def test_how_sure_a_rate_is_follows_from_the_number_counted() -> None:
    """The values stand in any table of exact Poisson intervals."""
    assert rate_bounds(0, 1.0) == pytest.approx((0.0, 3.689), abs=1e-3)
    assert rate_bounds(10, 2.0) == pytest.approx((4.795 / 2, 18.390 / 2), abs=1e-3)


# What is chosen is shown on answers that are written down here: a second each, at these seconds.

DONE = {"wave": range(0, 100, 10), "clap": range(5, 105, 10)}
MINUTES = 5.0


def heard(done: Mapping[str, Sequence[float]] = DONE, **told: dict[float | None, Sequence[float]]) -> Weighed:
    """A recording in which actions are done at these seconds, and by action what is found with each sensitivity."""

    def span(second: float) -> tuple[int, int]:
        return int(second * SECOND_NS), int((second + 1) * SECOND_NS)

    rates = {rate for of_action in told.values() for rate in of_action}
    searched = {
        rate: [
            sorted(
                (
                    Detection("a", 1, *span(second), span(second + 0.2)[1], label, 0.9)
                    for label, of_action in told.items()
                    for second in of_action.get(rate, ())
                ),
                key=lambda each: each.end_ns,
            )
        ]
        for rate in sorted(rates, key=lambda rate: (rate is not None, rate))
    }
    truths = [Truth("a", 1, *span(second), label) for label, seconds in done.items() for second in seconds]
    seen = Stretch("a", 1, 0, int((MINUTES * 60 + 20) * SECOND_NS))
    return Weighed(Trial("1", Found(truths=truths, seen=[seen]), searched))


def picked(weighed: Weighed, most_per_min: float | None = None) -> Choice:
    return chosen([weighed], most_per_min)


AT_ONCE = [0, 1.2, 2.4, 3.6, 20, 40]
PICKED = {
    "of two sensitivities that with the better F1": (
        heard(wave={None: DONE["wave"], 0.5: range(0, 50, 10)}, clap={None: DONE["clap"], 0.5: DONE["clap"]}),
        SpottingOptions(),
    ),
    "an action that is only false alarms is switched off": (
        heard(wave={None: DONE["wave"]}, clap={None: [150, 180]}, shrug={None: [152, 190, 230]}),
        SpottingOptions(disabled=frozenset({"clap", "shrug"})),
    ),
    "a cooldown for the action that is found twice and for no other": (
        heard(wave={None: [at + more for at in DONE["wave"] for more in (0, 1.3)]}, clap={None: DONE["clap"]}),
        SpottingOptions(cooldown_s={"wave": 0.5}),
    ),
    "a pause where wrong answers follow right ones at once": (
        heard(wave={None: [*DONE["wave"], *(at + 1.4 for at in DONE["clap"])]}, clap={None: DONE["clap"]}),
        SpottingOptions(shortest_pause_s=0.5),
    ),
    "nothing for a single false alarm": (
        heard(wave={None: [*DONE["wave"], 1.3]}, clap={None: DONE["clap"]}, shrug={None: [150]}),
        SpottingOptions(),
    ),
    "no pause that would spare two false waves and lose two of those that are done at once": (
        heard({"wave": AT_ONCE}, wave={None: [*AT_ONCE, 21.3, 41.3]}),
        SpottingOptions(),
    ),
}


@pytest.mark.parametrize("case", PICKED)
def test_the_settings_that_suit_are_picked(case: str) -> None:
    weighed, options = PICKED[case]
    assert picked(weighed).best.options == options


def test_where_few_false_alarms_are_wanted_the_best_that_has_as_few_is_chosen() -> None:
    false = [200 + 3 * n for n in range(11)]
    weighed = heard(wave={None: [*DONE["wave"], *false], 0.5: range(0, 40, 10)})
    assert picked(weighed).best.options.false_alarms_per_min is None
    choice = picked(weighed, most_per_min=1.0)
    assert (choice.best.options.false_alarms_per_min, choice.best.false_per_min) == (0.5, 0.0)


def test_where_none_has_as_few_that_with_the_fewest_is_chosen() -> None:
    weighed = heard(wave={None: [*DONE["wave"], *range(200, 290, 7)], 0.5: [*DONE["wave"], 210, 250]})
    choice = picked(weighed, most_per_min=0.1)
    assert choice.best.options.false_alarms_per_min == 0.5
    assert not choice.best.keeps_to(0.1)


def test_settings_are_also_held_against_recordings_they_were_not_picked_on() -> None:
    """The shrugs of one say nothing of the other, which has waves where this one has shrugs."""
    shrugs = heard(wave={None: DONE["wave"]}, shrug={None: [150, 180]})
    none = heard(wave={None: DONE["wave"]}, shrug={None: ()})
    assert len(held_out([shrugs, none], None).detections) == 10 + 2 + 10
    assert len(held_out([shrugs, shrugs], None).detections) == 10 + 10
