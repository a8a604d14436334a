"""What trainings learn from synthetic people, how it is scored, and what is said about it."""

import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console, RenderableType

from actum.recorder import write_recording
from actum.recording import Recording
from actum_model_trainer.baseline import nearest_neighbour
from actum_model_trainer.continuous.continuous_report import continuous_report
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.evaluation import evaluate
from actum_model_trainer.foreseeing.baselines import of_nearest_path
from actum_model_trainer.foreseeing.intent_report import intent_report
from actum_model_trainer.foreseeing.intent_scores import intent_scores
from actum_model_trainer.foreseeing.recorded import recorded_in
from actum_model_trainer.report import report
from actum_model_trainer.training import add_to, train, with_continuation
from actum_model_trainer.tuning.tuning import tuned
from actum_model_trainer.tuning.tuning_report import tuning_report
from approving import Approve
from continued import FROM_TORSO, continuation_of
from performers import HAND_PATHS, TINY
from reaching import messages
from som_classifier.model import Model
from som_classifier.presets import PRESETS
from unmarked import encoded_live, recorded, scene, spotting_model, taught

PLACED = dict.fromkeys(("concepts", "concept_mean", "layer3", "gains", "confidence"), 0.03)
"""Tolerances of what depends on which unit of the map of actions wins: another processor's rounding can decide that."""
OTHERS = scene((*HAND_PATHS, "swing", "lift", "push"), seed=9)


@pytest.fixture
def other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Recording:
    """Somebody who was not in the training; one push is labelled as a swing."""
    monkeypatch.chdir(tmp_path)
    marks = OTHERS.marks()
    marks[2] = marks[2].model_copy(update={"label": "swing"})
    return recorded(Path(), "other", [*OTHERS.skeletons(), *marks], "3")


def learnt(model: Model) -> dict[str, Any]:
    """Return all that a model's file holds; a direction and its opposite are the same."""
    arrays = {**model.arrays, **{f"kept {name}": each for name, each in model.kept.items()}}
    numbers = {name: np.abs(each) for name, each in arrays.items() if each.dtype.kind in "fiu"}
    return {"metadata": without_digests(model.metadata.model_dump()), "arrays": numbers}


def without_digests(metadata: dict[str, Any]) -> dict[str, Any]:
    kept = {name: each for name, each in metadata.items() if not name.endswith(("digest", "version", "updated_from"))}
    return {name: without_digests(each) if isinstance(each, dict) else each for name, each in kept.items()}


def lines_of(*shown: RenderableType) -> dict[str, str]:
    """Return what the terminal shows, by number of line."""
    console = Console(width=110, file=io.StringIO())
    for each in shown:
        console.print(each)
    return {f"{number:03}": line.rstrip() for number, line in enumerate(console.file.getvalue().splitlines())}


def continued(model: Model) -> list[object]:
    """Return the postures that a model predicts in the middle and at the end of each act."""
    frames = encoded_live(model, OTHERS)
    ends = [act.first + round(share * (act.last - act.first)) + 1 for act in OTHERS.acts for share in (0.5, 1.0)]
    return [continuation_of(model).ahead(frames[end - 15 : end]) for end in ends]


def recognised(model: Model) -> list[object]:
    """Return what a model says of the first half of each act, and of all of it."""
    frames = encoded_live(model, OTHERS)
    return [
        model.recognise(frames[act.first : act.first + round(share * (act.last - act.first)) + 1], share == 1.0)
        for act in OTHERS.acts
        for share in (0.5, 1.0)
    ]


def test_a_model_of_the_default_kind_learns_what_is_approved(approve: Approve) -> None:
    model = with_continuation(spotting_model(), taught().streams)
    approve("model", {"learnt": learnt(model), "continued": continued(model)}, 1e-4, PLACED)


def test_a_model_of_the_paper_s_kind_learns_what_is_approved(approve: Approve) -> None:
    model = with_continuation(train(taught().usable, FROM_TORSO), taught().streams)
    given = {"learnt": learnt(model), "continued": continued(model), "recognised": recognised(model)}
    approve("model-paper", given, 1e-4)


def test_a_model_learns_added_examples_as_approved(approve: Approve, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PRESETS, TINY.name, TINY)
    waves = [replace(each, label="wave", person="4") for each in taught().usable if each.label == "push"][:5]
    approve("model-added", learnt(add_to(spotting_model(), spotting_model().kept, waves, taught().streams)), 1e-2)


def test_a_model_is_scored_as_approved(other: Recording, approve: Approve) -> None:
    model = spotting_model()
    evaluation, found = evaluate(model, [other]), found_by(model, [other])
    tuning, nearest = tuned(model, [other]), nearest_neighbour([other], [other])
    scores = scores_of(found)
    approve(
        "scores",
        {"evaluation": evaluation, "found": found, "scores": scores, "tuned": tuning, "nearest": nearest},
        1e-4,
        PLACED,
    )
    shown = report(evaluation, 1.0), continuous_report(scores, 2.0), tuning_report(tuning, 1.0, 3.0)
    approve("score-reports", lines_of(*shown))


def test_intents_are_scored_as_approved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, approve: Approve) -> None:
    monkeypatch.chdir(tmp_path)
    stream = sorted(messages(), key=lambda message: message.stamp_ns or 0)
    write_recording(Path("reaches.mcap"), stream, person="1", source="test")
    takes = recorded_in([Recording(Path("reaches.mcap"))])
    scores = intent_scores(takes)
    nearest_path = of_nearest_path(takes.takes)(takes.takes[0])
    approve("intent-scores", {"takes": takes, "scores": scores, "nearest path": nearest_path}, 1e-5)
    approve("intent-report", lines_of(intent_report(scores, 1.0)))
