"""The commands on whole sets."""

from collections import Counter
from typing import Any

from actum.codec import encodable
from actum.commands import Command, NoFields, Refusal
from actum.node import Counters
from model_trainer.changes import Changes
from model_trainer.correction_commands import is_correction
from model_trainer.job_commands import JobCommands
from model_trainer.model_store import ModelStore
from model_trainer.replies import Done, Everything, ModelListed, SetListed, TakeListed
from model_trainer.requests import CreateSet, OfSet, RenameSet
from model_trainer.set_store import SetStore
from model_trainer.stored_set import StoredSet
from model_trainer.take_commands import TakeCommands
from som_classifier.presets import DEFAULT, PRESETS


class SetCommands:
    """Lists, creates, renames and deletes sets."""

    def __init__(
        self,
        sets: SetStore,
        models: ModelStore,
        changes: Changes,
        takes: TakeCommands,
        jobs: JobCommands,
        counters: Counters,
    ) -> None:
        self._sets = sets
        self._models = models
        self._changes = changes
        self._takes = takes
        self._jobs = jobs
        self._counters = counters
        self._counted: frozenset[str] = frozenset()

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        return (
            Command("list", NoFields, Everything, self._list),
            Command("create_set", CreateSet, Done, self._create),
            Command("rename_set", RenameSet, Done, self._rename),
            Command("delete_set", OfSet, Done, self._delete),
        )

    def _list(self, _: NoFields) -> Everything:
        """List all sets and models."""
        active, sets = self._models.active, list[SetListed]()
        models, unreadable = self._models.listed()
        since = next((each.created for each in models if each.id == active), "")
        for name in self._sets.names():
            try:
                sets.append(_listed(self._sets.get(name), since))
            except (OSError, Refusal) as error:  # its folder has vanished meanwhile, or cannot be read
                unreadable.append(encodable(str(error)))
        problems = [*unreadable, *(problem for each in sets for problem in each.unreadable)]
        for problem in problems:
            if problem not in self._counted:  # each once for as long as the file cannot be read
                self._counters.reject("unreadable_file", problem)
        self._counted = frozenset(problems)
        return Everything(
            sets=sets,
            models=[ModelListed.of(each, active) for each in models],
            active=active,
            presets=[DEFAULT.name, *(name for name in PRESETS if name != DEFAULT.name)],
            revision=self._changes.revision,
            unreadable=unreadable,
        )

    def _create(self, request: CreateSet) -> Done:
        """Make an empty set of examples."""
        return self._changes.made(self._sets.create, request.set)

    def _rename(self, request: RenameSet) -> Done:
        """Give a set another name."""
        self._refuse_busy(request.set)

        def rename() -> None:
            self._sets.rename(request.set, request.name)
            self._models.rename_set(request.set, request.name)

        return self._changes.made(rename)

    def _delete(self, request: OfSet) -> Done:
        """Delete a set with all its examples; models that were trained on it stay."""
        self._refuse_busy(request.set)
        return self._changes.made(self._sets.delete, request.set)

    def _refuse_busy(self, name: str) -> None:
        """Refuse what would take a set away from what works on it."""
        if self._takes.recording_to(name):
            raise Refusal(f"a recording into the set {name} is running: stop or discard this recording first")
        if job := self._jobs.working_on(name):
            raise Refusal(f"the set {name} is in use by {job}: wait until it ends, or cancel it")


def _listed(stored: StoredSet, since: str) -> SetListed:
    """Describe a set beside a model whose training began at that time (ISO 8601)."""
    return SetListed(
        name=stored.name,
        created=stored.created,
        actions=dict(sorted(Counter(label for take in stored.takes for label in take.labels).items())),
        people=sorted({take.person for take in stored.takes if take.person}),
        background_s=sum(take.background_s for take in stored.takes),
        corrections=sum(is_correction(take) and take.created > since for take in stored.takes),
        takes=[TakeListed.of(take) for take in stored.takes],
        unreadable=list(stored.unreadable),
    )
