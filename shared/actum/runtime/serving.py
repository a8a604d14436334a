"""Runs a service: connects, subscribes, steps, reports, and ends cleanly."""

import gc
import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TypeVar

from pydantic import ValidationError

from actum.command_line import from_command_line
from actum.node import Node, Source
from actum.runtime.parent import end_with_parent
from actum.runtime.place import RETURNING_S, SETTLING_S, PlaceTakenError
from actum.runtime.resuming import check_state_folder
from actum.runtime.service import Service
from actum.runtime.session import RETRY_S, open_session, secret_config
from actum.runtime.source_service import SourceService
from actum.runtime.step_service import NodeService
from actum.runtime.waiting import stop_on_signals
from actum.settings import ServiceSettings, SettingsError, complaint

log = logging.getLogger("actum")
S = TypeVar("S", bound=ServiceSettings)
N = TypeVar("N")
UNUSABLE = 2
"""Exit code of a process whose settings cannot be used."""
TAKEN = 3
"""Exit code of a process whose service another process runs already."""


def run(settings_type: type[S], build: Callable[[S], Node], flags: Sequence[str] | None = None) -> None:
    """Run a node as this process's service until SIGTERM or SIGINT, set by this process's flags or given ones."""
    settings, node = configured(settings_type, build, flags)
    live(NodeService(node, settings), settings)


def run_source(settings_type: type[S], build: Callable[[S], Source]) -> None:
    """Run a source as this process's service until SIGTERM or SIGINT."""
    settings, source = configured(settings_type, build)
    live(SourceService(source, settings), settings)


def configured(settings_type: type[S], build: Callable[[S], N], flags: Sequence[str] | None = None) -> tuple[S, N]:
    """Read the settings, from this process's flags or given ones, and build; if unusable, say why and exit with 2."""
    end_with_parent()
    service = settings_type.__module__.partition(".")[0]
    try:
        settings = from_command_line(settings_type, f"python -m {service}", flags)
        log_level()
        secret_config(settings)  # a wrong one is refused now, before the build, which may take long
        check_state_folder(settings)
        return settings, build(settings)
    except ValidationError as error:
        print(f"{service}: {complaint(error)} (see --help)", file=sys.stderr)
    except ValueError as error:
        print(f"{service}: {error}", file=sys.stderr)
    sys.exit(UNUSABLE)


def log_level() -> str:
    """Return the level of the log that `ACTUM_LOG` names, `INFO` where it names none.

    Raises:
        SettingsError: there is no such level.
    """
    named = os.environ.get("ACTUM_LOG") or "INFO"
    if named.upper() not in logging.getLevelNamesMapping():
        raise SettingsError(f"ACTUM_LOG: {named!r} is not a log level: use DEBUG, INFO, WARNING or ERROR")
    return named.upper()


def live(
    service: Service,
    settings: ServiceSettings,
    beside: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> None:
    """Connect, serve until SIGTERM or SIGINT, and exit: with code 0, 1 after a bug, 3 where another runs already.

    `beside` is entered before there is a router, and left at the end.
    """
    logging.basicConfig(level=log_level(), format=f"{service.name}: %(message)s")
    stop = stop_on_signals()
    service.end_at_bugs(stop)
    service.introduce()
    with beside():
        _serve(service, settings, stop)
    sys.exit(1 if service.failed else 0)


def _serve(service: Service, settings: ServiceSettings, stop: threading.Event) -> None:
    began_s = time.monotonic()
    session = open_session(settings, stop)
    if session is None:
        return
    settling_s = SETTLING_S if time.monotonic() - began_s < RETRY_S else RETURNING_S
    gc.freeze()  # objects that exist now live as long as the process: collections need not visit them again
    try:
        service.serve(session, stop, settling_s)
    except PlaceTakenError as error:
        log.error("%s", error)
        sys.exit(TAKEN)
    finally:
        session.close()
