"""The recogniser beside its peers on public recordings, all on one core."""

import os

for library in ("OPENBLAS", "OMP", "MKL", "NUMBA"):
    os.environ[f"{library}_NUM_THREADS"] = "1"  # before any of them is loaded
