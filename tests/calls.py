"""The calls that draw pixels, recorded."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest


def calls_of(monkeypatch: pytest.MonkeyPatch, owner: object, *names: str) -> dict[str, list[Any]]:
    """Record all arguments but the canvas of each call of some functions or methods, which go on to draw."""
    calls: dict[str, list[Any]] = {}

    def recording(name: str, draw: Callable[..., Any]) -> Callable[..., Any]:
        def drawing(*arguments: Any, **named: Any) -> Any:
            for at, each in [*enumerate(arguments[1:]), *named.items()]:
                calls.setdefault(f"{name} {at}", []).append(each if isinstance(each, str) else flat(each))
            return draw(*arguments, **named)

        return drawing

    for name in names:
        monkeypatch.setattr(owner, name, recording(name, getattr(owner, name)))
    return calls


def flat(argument: Any) -> Any:
    try:
        return np.ravel(np.asarray(argument, dtype=float))
    except (TypeError, ValueError):
        return None
