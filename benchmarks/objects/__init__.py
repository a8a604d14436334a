"""Which object is acted on, and what becomes of it, in simulated scenes that are hard to see; all on one core."""

import os

for library in ("OPENBLAS", "OMP", "MKL", "NUMBA"):
    os.environ[f"{library}_NUM_THREADS"] = "1"  # before any of them is loaded
