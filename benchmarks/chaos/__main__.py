"""Kill, pause and cut off services and routers while a scene is played, and judge every answer; about ten minutes.

python -m benchmarks.chaos [--seed N] [--faults N] [--segments N] [--model FILE] [--folder DIR]
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.simulated_model import SIMULATED_MODEL

from .faults import drawn
from .hosts import TwoHosts
from .judge import Judgement, judge
from .marking import Marker
from .recovery import measure
from .report import report
from .running import Run
from .scene import arguments_of, planned, undisturbed

SEGMENTS = 60
FAULTS = 40
SPARE = 20
"""Actions planned beyond those asked for: the first go by while the programs start, and faults may take longer."""


def main() -> int:
    """Run and print the report; return 0, or 1 where something was that must not be."""
    given = _arguments()
    folder = given.folder or Path(tempfile.mkdtemp(prefix="actum-chaos-"))
    folder.mkdir(parents=True, exist_ok=True)
    model = given.model
    actions = planned(given.seed, given.segments + SPARE)
    span_s = (actions[given.segments - 1].end_ns - actions[0].start_ns) / 1e9
    faults = drawn(given.seed, given.faults, span_s, given.only)
    print(f"seed {given.seed}: {len(faults)} faults while {given.segments} actions are done; log: {folder}/log.txt")
    here = ServiceSettings()
    services = processes.services(here, model, processes.simulated_objects())
    programs = [processes.simulator(here, arguments_of(given.seed)), *services]
    with TwoHosts(here, programs, folder, given.seed) as hosts:
        run = Run(hosts, Marker(actions), faults, given.segments, _say)
        run.play()
        sent, received = (carried / 1e6 for carried in hosts.link_bytes)
    _say("the scene is over, and is told undisturbed for comparison")
    measure(run.strikes, run.signs)
    marked = list(run.marker.marked.values())
    newest = max((each.action.number for each in marked), default=0)
    judgement = judge(marked, run.heard, undisturbed(given.seed, model, actions[:newest]), run.strikes)
    print("\n".join(report(judgement, run.strikes, run.heard)))
    print(f"the link carried {sent:.1f} MB to the compute host and {received:.1f} MB from it")
    return _verdict(judgement, given.seed)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.chaos", description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1, help="of the scene, its marks, the faults and their moments")
    parser.add_argument("--faults", type=int, default=FAULTS)
    parser.add_argument("--segments", type=int, default=SEGMENTS, help="how many actions are done, marked or not")
    parser.add_argument("--only", default="", help="only such faults, as 'killed', 'link' or 'som_classifier paused'")
    parser.add_argument("--model", type=Path, default=SIMULATED_MODEL, help="default: the simulated scene's")
    parser.add_argument("--folder", type=Path, help="for log, model and states; default: a new one")
    return parser.parse_args()


def _say(line: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {line}", flush=True)


def _verdict(judgement: Judgement, seed: int) -> int:
    """Print the verdict; return the exit code."""
    if judgement.violations:
        print(f"seed {seed}: {len(judgement.violations)} violations")
        return 1
    print(f"seed {seed}: every marked segment has one answer, right or rejected for a true reason")
    return 0


if __name__ == "__main__":
    sys.exit(main())
