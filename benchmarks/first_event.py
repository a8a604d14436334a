"""How long a newcomer waits: from the clone of this checkout's newest commit to the first event of `make demo`.

The clone lies in an empty folder, and everything is installed into it from the package index.
"""

import os
import re
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
STEPS = {
    "installed": re.compile(r"bin/actum demo"),
    "the page's address": re.compile(r"watch it in a browser"),
    "first event": re.compile(r"object [✓✗]"),
}
"""What is printed at each step, in this order."""


def lines_of(command: list[str], folder: Path) -> Iterator[str]:
    """Yield the lines that a command prints, and end it with Ctrl-C once nobody takes more."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("ACTUM_")}
    environment |= {"PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    assert process.stdout is not None
    try:
        yield from process.stdout
    finally:
        os.killpg(process.pid, signal.SIGINT)
        process.wait()


def main() -> None:
    """Print the seconds from the start of the clone to each step."""
    with tempfile.TemporaryDirectory(prefix="actum-first-event-") as folder:
        began_s, steps = time.monotonic(), iter(STEPS.items())
        subprocess.run(["git", "clone", "--quiet", str(ROOT), "actum"], cwd=folder, check=True)
        step, printed = next(steps)
        for line in lines_of(["make", "demo"], Path(folder) / "actum"):
            if printed.search(line):
                print(f"{time.monotonic() - began_s:5.1f} s  {step}", flush=True)
                step, printed = next(steps, ("", None))
                if printed is None:
                    return
        raise SystemExit(f"make demo ended before: {step}")


if __name__ == "__main__":
    main()
