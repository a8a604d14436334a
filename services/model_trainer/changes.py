"""What the trainer's commands share: the number of changes, and how a full disk or a damaged file is refused."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import wraps
from typing import Any, ParamSpec

from actum.commands import Command, Refusal
from actum.recording import RecordingError
from model_trainer.replies import Done

P = ParamSpec("P")


class Changes:
    """Counts the changes of sets and models, from the start's time on: a page that knows the revision of a trainer
    before this one has to list anew."""

    def __init__(self, start_ns: int) -> None:
        self.revision = start_ns // 1_000_000

    def made(self, change: Callable[P, object], *args: P.args, **kwargs: P.kwargs) -> Done:
        """Make a change by a function and its arguments, count the change, and return the reply.

        Raises:
            Refusal: a file could not be read or written; all are as they were.
        """
        with on_disk():
            change(*args, **kwargs)
        self.revision += 1
        return Done(revision=self.revision)


@contextmanager
def on_disk() -> Iterator[None]:
    """Refuse a command where its files cannot be read or written.

    Raises:
        Refusal: they cannot.
    """
    try:
        yield
    except (OSError, RecordingError) as error:
        raise Refusal(f"{file_problem(error)}; nothing was changed: solve this problem, then try again") from None


def refusing(command: Command[Any, Any]) -> Command[Any, Any]:
    """Return a command that is refused, instead of ending the service, where a file or folder of it has vanished."""

    @wraps(command.handler)
    def handler(request: Any) -> Any:
        try:
            return command.handler(request)
        except (OSError, RecordingError) as error:
            raise Refusal(f"{file_problem(error)}: repair the file or folder, and try again") from None

    return replace(command, handler=handler)


def file_problem(error: Exception) -> str:
    """Say what is wrong with a file without the number of the system's error."""
    if isinstance(error, OSError) and error.strerror:
        return ": ".join([*([str(error.filename)] if error.filename else []), error.strerror])
    return str(error)
