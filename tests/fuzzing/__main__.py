"""`make fuzz`: hostile messages at every service, then atheris on the codec and on the reader of recordings."""

import argparse
import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console
from rich.table import Table

from fuzzing.campaign import CrashError, Outcome, run
from fuzzing.targets import TARGETS

GUIDED = ("codec", "recording")
PATIENCE_S = 120
"""How long atheris may take to begin and to end beside its time (s)."""


def main() -> None:
    """Fuzz, print a table, and exit with 1 where anything was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--messages", type=int, default=100_000, help="to each service")
    parser.add_argument("--seconds", type=int, default=300, help="of atheris, for each of what it fuzzes; 0 for none")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    console = Console(highlight=False, width=110)
    well = _services(console, given.messages, given.seed)
    if given.seconds:
        well &= _guided(console, given.seconds, given.seed)
    sys.exit(0 if well else 1)


def _services(console: Console, messages: int, seed: int) -> bool:
    table = Table(title=f"{messages:,} messages to each service, seed {seed}")
    for column in ("service", "rejects", "kinds", "memory", "grown", "ms each", ""):
        table.add_column(column, justify="left" if column in ("service", "") else "right")
    verdicts = []
    for service in TARGETS:
        try:
            outcome = run(service, messages, seed)
        except CrashError as crash:
            console.print_exception()
            table.add_row(service, "", "", "", "", "", str(crash))
            verdicts.append(False)
        else:
            table.add_row(*_row(outcome))
            verdicts.append(outcome.flat)
    console.print(table)
    return all(verdicts)


def _row(outcome: Outcome) -> list[str]:
    return [
        outcome.service,
        f"{outcome.rejects:,}",
        str(outcome.kinds),
        f"{outcome.resident_bytes / 1e6:.0f} MB",
        f"{outcome.grown_bytes / 1e6:.1f} MB",
        f"{1000 * outcome.seconds / outcome.messages:.2f}",
        "well" if outcome.flat else "memory grows",
    ]


def _guided(console: Console, seconds: int, seed: int) -> bool:
    if find_spec("atheris") is None:
        console.print("atheris is not installed: pip install -e '.[fuzz]'")
        return False
    return all(_atheris(console, what, seconds, seed) for what in GUIDED)


def _atheris(console: Console, what: str, seconds: int, seed: int) -> bool:
    """Fuzz by atheris in a process of its own, in a folder that is kept where something was found."""
    folder = Path(tempfile.mkdtemp(prefix=f"actum-fuzz-{what}-"))
    command = [sys.executable, "-m", "fuzzing.coverage_guided", what, str(folder), str(seconds), str(seed)]
    log = folder / "log"
    with log.open("wb") as output:
        ended = subprocess.run(
            command, stdout=output, stderr=subprocess.STDOUT, timeout=seconds + PATIENCE_S, check=False, env=os.environ
        ).returncode
    said = log.read_text(errors="replace").splitlines()
    runs = next((line for line in said if line.startswith("Done ")), "it did not end")
    console.print(f"atheris, {what}: {runs}, {'found nothing' if ended == 0 else f'see {folder}'}")
    return ended == 0


if __name__ == "__main__":
    main()
