"""Wall clocks of processes, which a test sets apart and steps while they run; monotonic clocks stay as they are."""

import shutil
import struct
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

SOURCE = Path(__file__).with_name("wall_clock.c")
SECOND_NS = 1_000_000_000


def missing() -> str | None:
    """Say why no process can be given a wall clock of its own here, if so."""
    if sys.platform != "linux":
        return "wall clocks are set apart by LD_PRELOAD, on Linux"
    return None if shutil.which("cc") else "wall clocks are set apart by a C library: apt install gcc libc6-dev"


@cache
def library() -> Path:
    """Compile the library that stands between a process and its wall clock, once for each test process."""
    built = Path(mkdtemp(prefix="actum-clock-")) / "wall_clock.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-o", str(built), str(SOURCE), "-ldl"], check=True)
    return built


class WallClock:
    """The wall clock of all processes that are started with `variables`: the machine's, and an offset."""

    def __init__(self, file: Path, ahead_s: float) -> None:
        self._file = file
        file.write_bytes(_packed(ahead_s))
        self.variables = {"LD_PRELOAD": str(library()), "WALL_CLOCK": str(file)}

    def set(self, ahead_s: float) -> None:
        """Set it so far ahead of the machine's, at once and for all of its processes."""
        with self._file.open("r+b", buffering=0) as file:  # the same file: processes have it in their memory
            file.write(_packed(ahead_s))


def _packed(ahead_s: float) -> bytes:
    return struct.pack("q", round(ahead_s * SECOND_NS))
