"""Python programs as processes forked from one that has imported all services, which saves each the second of that."""

import gc
import multiprocessing
import os
import runpy
import signal
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from multiprocessing.process import BaseProcess
from pathlib import Path
from subprocess import TimeoutExpired
from typing import TextIO

FORKING = multiprocessing.get_context("forkserver")
PROGRAMS = (
    "action_fusion",
    "actum_command",
    "model_trainer",
    "marker_tracker",
    "pose_preprocessor",
    "ros2_bridge",
    "scene_simulator",
    "sensor_gateway",
    "som_classifier",
    "web_dashboard",
)
"""The packages whose `__main__` has a function `main`."""
IMPORTED_LATER = ("mcap.reader", "sensor_gateway.recording_source", "starlette.websockets", "uvicorn", "websockets")
"""What programs import as they run."""
FORKING.set_forkserver_preload([*(f"{program}.__main__" for program in PROGRAMS), *IMPORTED_LATER])


class Forked:
    """A forked program, with what tests use of `subprocess.Popen`."""

    def __init__(self, arguments: Sequence[str], environment: Mapping[str, str], output: Path, errors: Path) -> None:
        outputs = (str(output), str(errors))
        self._process: BaseProcess = FORKING.Process(
            target=_run, args=(tuple(arguments), dict(environment), str(Path.cwd()), outputs)
        )
        self._process.start()

    @property
    def pid(self) -> int:
        assert self._process.pid is not None
        return self._process.pid

    @property
    def returncode(self) -> int | None:
        return self._process.exitcode

    def poll(self) -> int | None:
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        self._process.join(timeout)
        if self.returncode is None:
            raise TimeoutExpired(self._process.name, timeout or 0.0)
        return self.returncode

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self) -> None:
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)


def _run(arguments: Sequence[str], environment: Mapping[str, str], folder: str, outputs: tuple[str, str]) -> None:
    gc.freeze()
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.orig_argv = [sys.executable, *arguments]
    for stream, name in zip((sys.stdout, sys.stderr), outputs, strict=True):
        _write_into(stream, name)
    match arguments:
        case ["-m", program, *given] if program in PROGRAMS:
            sys.argv = [program, *given]
            import_module(f"{program}.__main__").main()
        case ["-m", module, *given]:
            sys.argv = [module, *given]
            runpy.run_module(module, run_name="__main__", alter_sys=True)
        case ["-c", code, *given]:
            sys.argv = ["-c", *given]
            exec(compile(code, "<string>", "exec"), {"__name__": "__main__"})
        case [script, *given]:
            sys.argv = [script, *given]
            sys.path.insert(0, str(Path(script).parent))
            runpy.run_path(script, run_name="__main__")


def _write_into(stream: TextIO, name: str) -> None:
    opened = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(opened, stream.fileno())
    os.close(opened)
