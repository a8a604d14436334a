"""Whom the demo without marks trains on and tests."""

from actum_command import simulated_experiment as marked
from actum_command.unmarked_experiment import FIRST_UNSEEN, TRAINERS


def test_the_people_tested_neither_teach_nor_are_those_that_choices_were_made_on() -> None:
    unseen = marked.tested_actors(FIRST_UNSEEN, marked.PEOPLE)
    chosen_on = marked.tested_actors(marked.FIRST_TESTED, marked.PEOPLE)
    assert len(set(unseen)) == marked.PEOPLE
    assert not {*unseen} & {*TRAINERS, *chosen_on}


def test_without_others_one_who_teaches_is_tested() -> None:
    assert marked.tested_actors(FIRST_UNSEEN, people=0) == marked.tested_actors(marked.FIRST_TESTED, people=0)
    assert {*marked.tested_actors(FIRST_UNSEEN, people=0)} < {*TRAINERS}
