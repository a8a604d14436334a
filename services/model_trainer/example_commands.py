"""The commands that show and mend examples."""

from typing import Any

import numpy as np

from actum.arrays import Array
from actum.commands import Command, Refusal
from actum.recording import Recording, RecordingError
from actum_examples import edits
from actum_examples.marked_segment import MarkedSegment
from actum_examples.take import Take
from model_trainer.changes import Changes, file_problem, on_disk
from model_trainer.film import Film, films_of
from model_trainer.model_store import ModelStore
from model_trainer.recent_frames import SLACK_NS
from model_trainer.replies import Done, ExampleListed, Examples, FilmReply
from model_trainer.requests import DeleteAction, OfExample, OfSet, Relabel, Trim
from model_trainer.set_store import SetStore

MOST_FILMED = 16
"""Takes whose films are kept in memory: a page asks for those of a take one after the other."""


class ExampleCommands:
    """Shows the examples of sets, and mends them."""

    def __init__(self, sets: SetStore, models: ModelStore, changes: Changes) -> None:
        self._sets = sets
        self._models = models
        self._changes = changes
        self._films: dict[tuple[str, int, str | None], dict[str, Film]] = {}

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        return (
            Command("examples", OfSet, Examples, self._examples),
            Command("film", OfExample, FilmReply, self._film),
            Command("relabel", Relabel, Done, self._relabel),
            Command("trim", Trim, Done, self._trim),
            Command("mirror", OfExample, Done, self._mirror),
            Command("delete", OfExample, Done, self._delete),
            Command("delete_action", DeleteAction, Done, self._delete_action),
        )

    def remove(self, take: Take, examples: list[MarkedSegment]) -> None:
        """Delete examples of a take; one that was made here goes as a whole where it was of these alone.

        Raises:
            OSError: it cannot be written; it is as it was.
        """
        if take.kind == "action" and take.created and len(examples) == len(take.examples):
            take.path.unlink()
        else:
            edits.delete(take, examples)

    def _examples(self, request: OfSet) -> Examples:
        """List the examples of a set."""
        return Examples(
            examples=[
                ExampleListed.of(take, each) for take in self._sets.get(request.set).takes for each in take.examples
            ]
        )

    def _film(self, request: OfExample) -> FilmReply:
        """Show an example: the bodies, and the way over the posture map of the model in use."""
        take, example = self._found(request)
        film = self._films_of(take).get(example.segment_id)
        if film is None:
            raise Refusal(f"the example {request.example} has no usable frame to show: delete this example")
        trace = None if film.trace is None else np.round(film.trace, 2).tolist()
        return FilmReply(stamps_ns=list(film.stamps_ns), joints=[_listed(body) for body in film.joints], trace=trace)

    def _relabel(self, request: Relabel) -> Done:
        """Give an example another label."""
        take, example = self._found(request)
        return self._changes.made(edits.relabel, take, example, request.label)

    def _trim(self, request: Trim) -> Done:
        """Give an example another start and end."""
        take, example = self._found(request)
        assert example.bounds_ns is not None
        bounds = zip(example.bounds_ns, (request.start_ns, request.end_ns), strict=True)
        start_ns, end_ns = (old if abs(new - old) <= SLACK_NS else new for old, new in bounds)
        try:
            return self._changes.made(edits.move, take, example, start_ns, end_ns)
        except edits.EditError as error:
            raise Refusal(str(error)) from None

    def _mirror(self, request: OfExample) -> Done:
        """Exchange left and right in an example and those that share frames with it; twice is as before."""
        take, example = self._found(request)
        return self._changes.made(edits.mirror, take, example)

    def _delete(self, request: OfExample) -> Done:
        """Delete an example with the frames of whoever acts in it, unless another example needs them."""
        take, example = self._found(request)
        return self._changes.made(self.remove, take, [example])

    def _delete_action(self, request: DeleteAction) -> Done:
        """Delete all examples of an action."""
        takes = [take for take in self._sets.get(request.set).takes if request.label in take.labels]
        if not takes:
            raise Refusal(f"the set {request.set} has no example of {request.label!r}: choose another action")
        for done, take in enumerate(takes):
            try:
                self.remove(take, [each for each in take.examples if each.label == request.label])
            except (OSError, RecordingError) as error:
                left = f"the examples in {len(takes) - done} of {len(takes)} recordings were not deleted"
                raise Refusal(f"{file_problem(error)}; {left}: solve this problem, then try again") from None
            self._changes.revision += 1
        return Done(revision=self._changes.revision)

    def _found(self, request: OfExample) -> tuple[Take, MarkedSegment]:
        for take in self._sets.get(request.set).takes:
            for example in take.examples:
                if take.name_of(example) == request.example:
                    return take, example
        raise Refusal(
            f"the set {request.set} has no example {request.example!r}: use an id that the command 'examples' lists "
            "for this set"
        )

    def _films_of(self, take: Take) -> dict[str, Film]:
        """Return the films of a take, of the file as it is now and by the model in use."""
        model = self._models.loaded
        with on_disk():
            key = str(take.path), take.path.stat().st_mtime_ns, None if model is None else model.id
            if key not in self._films:
                self._films[key] = films_of(Recording(take.path), model)
        for oldest in list(self._films)[:-MOST_FILMED]:
            del self._films[oldest]
        return self._films[key]


def _listed(body: Array) -> list[list[float] | None]:
    """List the joints (15, 3) of a body to the millimetre; null where one is missing."""
    return [None if np.isnan(joint).any() else np.round(joint, 3).tolist() for joint in body]
