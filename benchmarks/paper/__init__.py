"""The paper's recogniser by the protocols that it has been measured by, its steps one by one, and its figures."""

import os

for library in ("OPENBLAS", "OMP", "MKL", "NUMBA"):
    os.environ[f"{library}_NUM_THREADS"] = "1"  # before any of them is loaded
