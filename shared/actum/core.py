"""The compiled steps of `_compiled.c`: an installation compiles them where it finds a C compiler."""

from importlib import import_module
from types import ModuleType


def _compiled() -> ModuleType | None:
    try:
        return import_module("actum._compiled")
    except ImportError:
        return None


steps = _compiled()
"""The functions; None where they were not compiled, and NumPy code does the same."""
