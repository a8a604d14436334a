"""Self-organising maps: train, look up, measure, store.

>>> import numpy as np
>>> colours = np.random.default_rng(0).random((1000, 3))
>>> som = Som.linear(10, 12, colours).train_batch(colours, epochs=20, radius=(5.0, 0.7))
>>> som.planes.shape, som.bmus(colours[:4]).shape, som.best_two(colours[:4]).shape
((10, 12, 3), (4,), (4, 2))
>>> som.quantization_error(colours) < 0.15
True

Sequential training takes one input after the other; it can be stopped, saved and resumed without a trace:

>>> schedule = Schedule(alpha=(0.5, 0.02), radius=(5.0, 0.7))
>>> trained = som.train(colours, 5000, schedule, np.random.default_rng(1))

Where Numba is installed sequential training is compiled; the maps are the same to the bit.
"""

from actum.som.batch import BatchTraining
from actum.som.codebook import Codebook
from actum.som.grid import Grid, Topology
from actum.som.kernel import adapt_in_numpy
from actum.som.map import Som
from actum.som.schedule import Decay, Report, Schedule, Steps
from actum.som.sequential import SequentialTraining
from actum.som.storage import SomError
from actum.som.together import Together

__all__ = [
    "BatchTraining",
    "Codebook",
    "Decay",
    "Grid",
    "Report",
    "Schedule",
    "SequentialTraining",
    "Som",
    "SomError",
    "Steps",
    "Together",
    "Topology",
    "adapt_in_numpy",
]
