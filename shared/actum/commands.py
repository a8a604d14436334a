"""Commands that a service answers on its queryables: what each is called, asks for, replies, and does."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel


class Refusal(ValueError):
    """A command that cannot be done as it was asked; the text says why and what to do, and is told to the asker."""


@dataclass(frozen=True)
class Command:
    """A command: its name, the fields of its request and of its reply, and what does it."""

    name: str
    request: type[BaseModel]
    reply: type[BaseModel]
    handler: Callable[[Any], BaseModel]
