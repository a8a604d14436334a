"""The model that comes with actum, and whom the demo tests it on."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from actum_command.demo import marked
from actum_command.demo.unmarked import FIRST_UNSEEN
from actum_command.simulated_model import SIMULATED_MODEL, TRAINERS, learned_from, trained
from actum_model_trainer.progress import silent
from scene_simulator.programme import ACTIONS
from som_classifier.model_loading import load_model
from som_classifier.presets import DEFAULT


def test_the_model_finds_the_actions_of_the_simulated_scene_by_itself() -> None:
    model = load_model(SIMULATED_MODEL)
    assert {*model.metadata.labels} == {*ACTIONS}
    assert model.metadata.spotting is not None  # type: ignore[attr-defined]
    assert learned_from(model) == "90 actions of 9 simulated people"


def test_the_model_was_trained_with_the_default_preset_as_it_is() -> None:
    assert load_model(SIMULATED_MODEL).metadata.parameters == json.loads(json.dumps(asdict(DEFAULT)))


@pytest.mark.long
@pytest.mark.timeout(400)
def test_the_model_is_what_its_command_trains(tmp_path) -> None:
    trained(silent).save(tmp_path / "model.npz")
    with np.load(tmp_path / "model.npz") as anew, np.load(SIMULATED_MODEL) as shipped:
        assert {*anew} == {*shipped}
        for name in {*shipped} - {"metadata"}:
            np.testing.assert_array_equal(anew[name], shipped[name], err_msg=name)


def test_the_people_tested_neither_teach_nor_are_those_that_choices_were_made_on() -> None:
    people = 9  # as many as `actum demo --people 9`, the longest test, shows
    unseen = marked.tested_actors(FIRST_UNSEEN, people)
    chosen_on = marked.tested_actors(marked.FIRST_TESTED, people)
    assert len(set(unseen)) == people
    assert not {*unseen} & {*TRAINERS, *chosen_on}


def test_without_others_one_who_teaches_is_tested() -> None:
    assert marked.tested_actors(FIRST_UNSEEN, people=0) == marked.tested_actors(marked.FIRST_TESTED, people=0)
    assert {*marked.tested_actors(FIRST_UNSEEN, people=0)} < {*TRAINERS}
