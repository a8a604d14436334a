"""Compares the speed of this tree with another commit's, in turns, and names what became slower (make check-speed).

python -m benchmarks.speed COMMIT [ROUNDS]

The other commit runs from a work tree of its own with the packages of this environment. Exits with code 1 where
something is slower by a tenth or more.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from hatch_build import LIBRARY, SOURCE, compiled
from rich.console import Console
from rich.table import Table

from actum import core

ROOT = Path(__file__).parents[2]
SLOWER = 0.9
"""Ratio of this tree's speed to the other's below which something counts as slower."""
Rates = Mapping[str, float]


def main(commit: str, rounds: int) -> bool:
    """Measure both trees in turns and print the table; return whether nothing is slower."""
    console = Console(highlight=False, width=110)
    with tempfile.TemporaryDirectory() as name:
        other = Path(name) / "tree"
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", other, commit], cwd=ROOT, check=True)
        try:
            # an older commit has no steps
            if core.steps is not None and (other / SOURCE).exists():
                problem = compiled(other / SOURCE, other / LIBRARY)
                assert problem is None, problem
            turns = [(measured(ROOT), measured(other)) for _ in range(rounds)]
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", other], cwd=ROOT, check=True)
    here, there = ([turn[n] for turn in turns] for n in (0, 1))
    ratios = {what: median(rates[what] for rates in here) / median(rates[what] for rates in there) for what in here[0]}
    console.print(table(here, there, ratios, commit))
    slower = [what for what, ratio in ratios.items() if ratio < SLOWER]
    console.print(f"slower by a tenth or more: {'; '.join(slower) if slower else 'nothing'}")
    return not slower


def measured(tree: Path) -> Rates:
    """Run the measurements of this tree with the code of another, on one core."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, (tree / "shared", tree / "services", tree))),
        "OPENBLAS_NUM_THREADS": "1",
    }
    measure = Path(__file__).with_name("measure.py")
    done = subprocess.run([sys.executable, measure], cwd=tree, env=environment, stdout=subprocess.PIPE, check=True)
    rates: Rates = json.loads(done.stdout)
    return rates


def table(here: Sequence[Rates], there: Sequence[Rates], ratios: Rates, commit: str) -> Table:
    """Lay out the medians of all rounds."""
    made = Table("larger is faster", title=f"{len(here)} rounds in turns, medians")
    for heading in ("this tree", commit[:10], "ratio"):
        made.add_column(heading, justify="right")
    for what, ratio in ratios.items():
        medians = (f"{median(rates[what] for rates in each):,.1f}" for each in (here, there))
        made.add_row(what, *medians, f"{ratio:.2f}")
    return made


if __name__ == "__main__":
    sys.exit(0 if main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 3) else 1)
