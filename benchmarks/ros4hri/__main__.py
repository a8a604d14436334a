"""Print what ROS4HRI costs in accuracy, how rightly postures are told, and the time of the bridge's step.

ACTUM_DATA=… python -m benchmarks.ros4hri
"""

import tempfile
from itertools import chain
from pathlib import Path

from benchmarks.originals import ImportedSets
from benchmarks.ros4hri.cost import of_cost
from benchmarks.ros4hri.postures import of_postures
from benchmarks.ros4hri.round_trip import of_round_trip


def main() -> None:
    """Measure, and print."""
    with tempfile.TemporaryDirectory() as folder:
        data = ImportedSets(Path(folder))
        for line in chain(of_cost(), of_postures(data), of_round_trip(data)):
            print(line, flush=True)


if __name__ == "__main__":
    main()
