"""What the marker tracker costs for an image and how exact it is, beside OpenCV; all on one core."""

import os

for library in ("OPENBLAS", "OMP", "MKL", "NUMBA"):
    os.environ[f"{library}_NUM_THREADS"] = "1"  # before any of them is loaded
