"""How long a newcomer waits: from the clone of this checkout's newest commit to the first event, by two ways.

`make demo`, and the commands of the README's *Run*. Each begins with a clone in an empty folder, into which everything
is installed from the package index.
"""

import os
import re
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[1]
BOUND_S = 180.0
"""What the README's *Run* may take from the clone to the first event (s)."""
DEMO = {
    "installed": re.compile(r"bin/actum demo"),
    "the page's address": re.compile(r"watch it in a browser"),
    "first event": re.compile(r"object [✓✗]"),
}
"""What `make demo` prints at each step, in this order."""
UP = {
    "installed": re.compile(r"actum starts on"),
    "the page's address": re.compile(r"the page: http"),
}
"""What the first terminal prints."""
WATCH = {"first own event": re.compile(r"event/\d")}
"""What the second terminal prints, in which `actum watch` is started."""
RUN = "make install && . .venv/bin/activate && actum up --everyday all --pauses short --segments both"
"""The README's *Run*: what is typed in the first terminal."""
WATCHING = ". .venv/bin/activate && actum watch"
"""What is typed in the second one."""


@contextmanager
def lines_of(command: list[str], folder: Path) -> Iterator[Iterator[str]]:
    """Yield the lines that a command prints; end it with Ctrl-C after that."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("ACTUM_")}
    environment |= {"PYTHONUNBUFFERED": "1", "XDG_DATA_HOME": str(folder / "data")}  # a newcomer has taught nothing
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    try:
        yield iter(process.stdout)
    finally:
        os.killpg(process.pid, signal.SIGINT)
        process.wait()


def wait_for(steps: Mapping[str, re.Pattern[str]], lines: Iterator[str], began_s: float) -> float:
    """Print the seconds from the beginning to each step that lines tell of, in this order; return the last."""
    passed_s = 0.0
    for step, printed in steps.items():
        if not any(printed.search(line) for line in lines):
            raise SystemExit(f"it ended before: {step}")
        passed_s = time.monotonic() - began_s
        print(f"{passed_s:5.1f} s  {step}", flush=True)
    return passed_s


@contextmanager
def cloned() -> Iterator[Path]:
    """Clone this checkout's newest commit into an empty folder."""
    with tempfile.TemporaryDirectory(prefix="actum-first-event-") as folder:
        subprocess.run(["git", "clone", "--quiet", str(ROOT), "actum"], cwd=folder, check=True)
        yield Path(folder) / "actum"


def main() -> None:
    """Print the seconds from the start of the clone to each step, of both ways."""
    print("clone, make demo:")
    began_s = time.monotonic()
    with cloned() as folder, lines_of(["make", "demo"], folder) as demo:
        wait_for(DEMO, demo, began_s)
    print("clone, the README's Run:")
    began_s = time.monotonic()
    with cloned() as folder, lines_of(["sh", "-c", RUN], folder) as up:
        wait_for(UP, up, began_s)
        with lines_of(["sh", "-c", WATCHING], folder) as watch:
            passed_s = wait_for(WATCH, watch, began_s)
    print(f"       {'within' if passed_s <= BOUND_S else 'not within'} the {BOUND_S:.0f} s that are wanted")


if __name__ == "__main__":
    main()
