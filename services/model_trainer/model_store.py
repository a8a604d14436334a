"""Models on the disk, and which of them the classifier uses."""

import json
import os
from collections.abc import Callable
from pathlib import Path

from pydantic import TypeAdapter

from actum.atomic_file import clear_unfinished, write_whole
from actum.codec import encodable
from actum.commands import Refusal
from model_trainer.set_store import date_of
from model_trainer.small_files import copy, small_file
from model_trainer.stored_model import ID, About, StoredModel, described, stored
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, load_model

HISTORY = "history.json"
"""The file with the models that were in use before, in order."""
MOST_BEFORE = 50
"""Models that the history remembers: nobody undoes more."""
IDS = TypeAdapter(list[str])
"""The form of the history."""


class ModelStore:
    """The models in a folder, and the file that the classifier watches.

    A model that somebody else has put there is kept as one more, so that it can be returned to. What is put into use
    here is also stored as `taught`, where the next run finds it.

    Attributes:
        active: the id of the model that the classifier is to use; None where there is none.
        loaded: that model itself.
        set: the set that it was trained on; None where that is not known.
    """

    def __init__(self, folder: Path, watched: Path, taught: Path, now_ns: Callable[[], int]) -> None:
        self._folder = folder
        self._watched, self._taught = watched, taught
        self._now_ns = now_ns
        self._version: tuple[int, int] | None = None
        self.active: str | None = None
        self.loaded: Model | None = None
        self.set: str | None = None
        self._history = _read_history(folder / HISTORY)
        folder.mkdir(parents=True, exist_ok=True)
        clear_unfinished(folder)
        self.look()

    @property
    def before(self) -> list[str]:
        """The models that were in use before and are still there, in order."""
        there = [each for each in self._history if os.path.exists(self._path(each))]  # noqa: PTH110 - without access it is not there, which is no error
        while there and there[-1] == self.active:
            there.pop()
        return there

    def listed(self) -> tuple[list[StoredModel], list[str]]:
        """List the models, the oldest first, and of each file that cannot be read why."""
        found, unreadable = dict[str, StoredModel](), list[str]()
        for path in sorted(self._folder.glob("*.npz")):
            try:
                each = described(path) or self._take_over(path)
                found[each.id] = each
            except (OSError, ModelError) as error:
                unreadable.append(encodable(str(error)))
        return sorted(found.values(), key=lambda each: (each.created, each.id)), unreadable

    def get(self, model_id: str) -> StoredModel:
        """Return a model's description.

        Raises:
            Refusal: there is none of that id.
        """
        for each in self.listed()[0]:
            if each.id == model_id:
                return each
        raise Refusal(f"there is no model {model_id!r}: use an id that the command 'list' lists")

    def add(self, file: Path, set_name: str, scores: dict[str, float], created: str) -> StoredModel:
        """Keep a copy of a model file whose training began at that time (ISO 8601).

        Raises:
            ModelError: it is none.
            OSError: it cannot be written.
        """
        model = load_model(file)
        self._describe(model, set_name, scores, created)
        copy(file, self._path(model.id))
        return self.get(model.id)

    def activate(self, model_id: str) -> None:
        """Put a model in the place of the one in use and of the one that was taught last, of which copies stay.

        Raises:
            Refusal: the model cannot be loaded, or one of those is none that could be returned to.
            OSError: a file cannot be written, or no copy of it be kept.
        """
        path = self.get(model_id).path
        try:
            load_model(path)
        except ModelError as error:
            raise Refusal(str(error)) from None
        self.look()
        places = dict.fromkeys((self._taught, self._watched))
        for place in places:
            self._spare(place)
        for place in places:
            copy(path, place)
        self.look()

    def undo(self) -> None:
        """Return to the model that was in use before.

        Raises:
            Refusal: there was none.
            OSError: the file cannot be written.
        """
        before = self.before
        if not before:
            raise Refusal(
                "no model was in use before this one, so there is no model to return to: choose a model with the "
                "command 'activate'"
            )
        self.activate(before[-1])
        self._remember(before[:-1])

    def delete(self, model_id: str) -> None:
        """Delete a model.

        Raises:
            Refusal: there is none of that id, or it is in use.
        """
        path = self.get(model_id).path
        if model_id == self.active:
            raise Refusal(f"model {model_id} is in use: use another model first, then delete this model")
        path.unlink()
        path.with_suffix(".json").unlink(missing_ok=True)

    def rename_set(self, name: str, new_name: str) -> None:
        """Note of each model that was trained on a set that the set has another name now.

        Raises:
            OSError: it cannot be noted.
        """
        for each in self.listed()[0]:
            if each.set == name:
                renamed = each.model_copy(update={"set": new_name})
                write_whole(each.path.with_suffix(".json"), renamed.model_dump_json().encode())
        if self.set == name:
            self.set = new_name

    def look(self) -> bool:
        """Look whether the watched file has changed, and return that.

        Raises:
            OSError: it is none of ours, and no copy of it can be kept.
        """
        try:
            stat = self._watched.stat()
            version = stat.st_mtime_ns, stat.st_size
        except OSError:
            version = None
        if version == self._version:
            return False
        self._version = version
        before = self.active
        self._take_in()
        if before is not None and before != self.active:
            self._remember([*self.before, before])
        return True

    def _take_in(self) -> None:
        """Read the watched file, and keep a copy of it where it is none of ours."""
        try:
            self.loaded = load_model(self._watched)
        except ModelError:
            self.loaded = self.active = self.set = None
            return
        self.active = self.loaded.id
        about = described(self._path(self.active))
        self.set = (about and about.set) or None
        self._keep_copy(self._watched, self.active)

    def _keep_copy(self, file: Path, model_id: str) -> None:
        """Keep a copy of a file, which is a model of that id, where there is none.

        Raises:
            OSError: it cannot be kept.
        """
        if not self._path(model_id).exists():
            try:
                self.add(file, "", {}, self._now())
            except (ModelError, Refusal) as error:  # it was replaced meanwhile, or nothing can be read here
                raise OSError(str(error)) from None

    def _spare(self, place: Path) -> None:
        """Keep a copy of the model in a file that is to be replaced.

        Raises:
            Refusal: it is none that could be returned to.
            OSError: no copy can be kept.
        """
        if not os.path.lexists(place):
            return
        try:
            model_id = load_model(place).id
        except ModelError:
            raise Refusal(
                f"the file {place} cannot be read as a model and would be overwritten: move this file to another "
                "folder, then try again"
            ) from None
        self._keep_copy(place, model_id)

    def _remember(self, ids: list[str]) -> None:
        write_whole(self._folder / HISTORY, json.dumps(ids[-MOST_BEFORE:]).encode())
        self._history = ids[-MOST_BEFORE:]

    def _path(self, model_id: str) -> Path:
        return self._folder / f"{model_id}.npz"

    def _now(self) -> str:
        return date_of(self._now_ns())

    def _describe(self, model: Model, set_name: str, scores: dict[str, float], created: str) -> StoredModel:
        """Write beside a model's file what is listed of it."""
        about = About(
            created=created,
            set=set_name,
            labels=list(model.labels),
            people=model.metadata.persons,
            samples=model.metadata.samples,
            scores=scores,
        )
        path = self._path(model.id)
        write_whole(path.with_suffix(".json"), about.model_dump_json().encode())
        return stored(path, about)

    def _take_over(self, path: Path) -> StoredModel:
        """Describe a model that somebody has copied here, and name its file as all others.

        Raises:
            ModelError: it is none.
            OSError: it cannot be described.
        """
        model = load_model(path)
        taken = self._describe(model, "", {}, self._now())
        path.replace(taken.path)
        return taken


def _read_history(path: Path) -> list[str]:
    try:
        ids = IDS.validate_json(small_file(path))
    except (OSError, ValueError):
        return []
    return [each for each in ids if ID.fullmatch(each)]
