"""Runs commands as a user types them, in this process, and writes the recordings that they read."""

from functools import cache
from pathlib import Path

from typer import testing
from typer.main import get_command
from typer.testing import CliRunner, Result

from actum.messages import Message
from actum.recorder import write_recording
from actum_command.__main__ import app

testing._get_command = cache(get_command)  # type: ignore[attr-defined]
testing._get_command(app)  # type: ignore[attr-defined]  # takes 20 ms: once, before any test changes what is declared


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def printed(*arguments: object) -> str:
    """What a command prints that ends well."""
    done = invoke(*arguments)
    assert done.exit_code == 0, done.output
    return done.stdout


def refused(*arguments: object) -> str:
    """The one line by which a command says why it ends with code 1."""
    ended = invoke(*arguments)
    assert ended.exit_code == 1, ended.output
    assert isinstance(ended.exception, SystemExit), ended.exception
    assert ended.stderr.count("\n") == 1, ended.stderr
    return ended.stderr.strip()


def written(path: Path, *messages: Message, person: str = "anna") -> Path:
    write_recording(path, messages, person=person, source="test")
    return path
