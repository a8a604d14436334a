"""The commands that put models into use."""

from typing import Any

from actum.commands import Command, NoFields, Refusal
from model_trainer.changes import Changes
from model_trainer.model_store import ModelStore
from model_trainer.replies import Comparison, Done, ModelListed, counted
from model_trainer.requests import Compare, OfModel


class ModelCommands:
    """Puts models into use and back, and compares and deletes them."""

    def __init__(self, models: ModelStore, changes: Changes) -> None:
        self._models = models
        self._changes = changes

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        return (
            Command("activate", OfModel, Done, self._activate),
            Command("undo", NoFields, Done, self._undo),
            Command("delete_model", OfModel, Done, self._delete),
            Command("compare", Compare, Comparison, self._compare),
        )

    def _activate(self, request: OfModel) -> Done:
        """Put a model into use, without a gap: the classifier takes it within a second."""
        return self._changes.made(self._models.activate, request.model)

    def _undo(self, _: NoFields) -> Done:
        """Return to the model that was in use before."""
        return self._changes.made(self._models.undo)

    def _delete(self, request: OfModel) -> Done:
        """Delete a model that is not in use."""
        return self._changes.made(self._models.delete, request.model)

    def _compare(self, request: Compare) -> Comparison:
        """Set a model beside another, or beside the one in use."""
        other_id = request.with_ or self._models.active
        if other_id is None:
            raise Refusal(
                "the model cannot be compared with the model in use, because no model is in use: give the id of "
                "another model in the field 'with'"
            )
        active = self._models.active
        one, other = (ModelListed.of(self._models.get(each), active) for each in (request.model, other_id))
        return Comparison(
            model=one,
            other=other,
            added=sorted({*one.labels} - {*other.labels}),
            missing=sorted({*other.labels} - {*one.labels}),
            sentence=_sentence(one, other),
        )


def _sentence(one: ModelListed, other: ModelListed) -> str:
    """Say what the difference of two models comes to."""
    people = counted(len(one.people), "person", "people")
    parts = [f"{counted(one.samples, 'example')} by {people}, instead of {other.samples} by {len(other.people)}"]
    if one.labels != other.labels:
        parts.append(f"{counted(len(one.labels), 'action')} instead of {len(other.labels)}")
    name = "accuracy_held_out"
    if name in one.scores and name in other.scores:
        parts.append(f"{one.scores[name]:.0%} of examples left out recognised, instead of {other.scores[name]:.0%}")
    return f"{one.id}, compared with {other.id}: {'; '.join(parts)}"
