"""Finds and starts OpenNI 2 through its Python bindings."""

import os
from typing import Any

from actum.installing import install_command

LIBRARIES = "libOpenNI2.so.0", "libOpenNI2.so", "libOpenNI2.dylib", "OpenNI2.dll"
"""File names of the library on Debian, other Linux, macOS and Windows, in the order in which they are tried."""
FOLDERS = "OPENNI2_REDIST64", "OPENNI2_REDIST"
"""Environment variables that name a folder with another build of the library, such as Orbbec's."""


class OpenNiError(ValueError):
    """The library is not installed; the message names the remedy and `problem`."""

    def __init__(self, problem: str) -> None:
        remedy = f"run {install_command('openni2')}; on Debian also run: apt install libopenni2-0"
        super().__init__(f"the source openni2 needs OpenNI 2 ({problem}): {remedy}")


def library() -> Any:
    """Import the bindings and start the library, once in a process.

    Raises:
        OpenNiError: the bindings or the library are not installed.
    """
    try:
        from openni import openni2
    except ImportError as error:
        raise OpenNiError(str(error)) from None
    except TypeError:  # the bindings' enumerations are abstract classes to ctypes since Python 3.13
        raise OpenNiError(
            "the Python bindings of OpenNI 2 do not work on Python 3.13 or newer: use Python 3.11 or 3.12"
        ) from None
    if not openni2.is_initialized():
        from openni.utils import InitializationError, OpenNIError

        # the folder that the environment names, or else the system's, which the bindings miss
        folders = [os.environ[name] for name in FOLDERS if name in os.environ]
        try:
            if not folders and not openni2.loaded_dll_directory:
                openni2.loaded_dll_directory = _load(openni2.c_api)
            openni2.initialize(folders)
        except (InitializationError, OpenNIError) as error:
            raise OpenNiError(error_text(error)) from None
    return openni2


def _errors() -> tuple[type[Exception], ...]:
    """Return the classes of errors that the bindings raise; empty if they are not installed."""
    try:
        from openni.utils import OpenNIError
    except ImportError:
        return ()
    return (OpenNIError,)


def error_text(error: Exception) -> str:
    """Return the message of an error of the bindings; its arguments are a code, the message in bytes, a file name."""
    message = error.args[1] if len(error.args) > 1 else error
    return message.decode(errors="replace") if isinstance(message, bytes) else str(message)


ERRORS = _errors()


def _load(c_api: Any) -> str:
    """Load the system's library into the bindings; return its name."""
    problems = []
    for name in LIBRARIES:
        try:
            c_api.load_dll(name)
        except OSError as error:
            problems.append(str(error))
        else:
            return name
    raise OpenNiError(problems[0])
