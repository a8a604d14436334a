"""The compiled steps of `_compiled.c`: an installation compiles them where it finds a C compiler."""

import hashlib
import logging
from importlib import import_module
from pathlib import Path
from types import ModuleType

SOURCE = Path(__file__).with_name("_compiled.c")
"""The source beside this module."""


def _compiled() -> ModuleType | None:
    try:
        module = import_module("actum._compiled")
    except ImportError:
        return None
    if SOURCE.exists() and getattr(module, "source", "") != hashlib.sha256(SOURCE.read_bytes()).hexdigest():
        logging.getLogger("actum").warning(
            "the compiled code was built from another version of _compiled.c, so slower NumPy code runs instead: run "
            "'make install', or install actum again"
        )
        return None
    return module


steps = _compiled()
"""The functions; None where they were not compiled, and NumPy code does the same."""
