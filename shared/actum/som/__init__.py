"""Self-organising maps: train, look up, measure.

>>> import numpy as np
>>> colours = np.random.default_rng(0).random((1000, 3))
>>> som = Som.linear(10, 12, colours).train_batch(colours, epochs=20, radius=(5.0, 0.7))
>>> som.planes.shape, som.bmus(colours[:4]).shape, som.best_two(colours[:4]).shape
((10, 12, 3), (4,), (4, 2))
>>> som.quantization_error(colours) < 0.15
True

Learning returns a new map. Sequential training takes one input after the other, drawn with the generator that is given:

>>> schedule = Schedule(alpha=(0.5, 0.02), radius=(5.0, 0.7))
>>> trained = som.train(colours, 5000, schedule, np.random.default_rng(1))

A map says how well it fits its inputs and keeps their order, over 8 neighbours of a unit or over 4:

>>> som.topographic_error(colours) < 0.1, som.topographic_error(colours, neighbours=4) < 0.5
(True, True)
>>> som.u_matrix().shape
(10, 12)

Inputs are rows of numbers, an array or what NumPy makes one of; NaN is a missing value. With a C
compiler, the installation compiles sequential training; the maps are the same to the bit.
"""

from actum.som.batch import BatchTraining
from actum.som.codebook import Codebook
from actum.som.kernel import adapt_in_numpy
from actum.som.map import Som
from actum.som.schedule import Report, Schedule, Steps
from actum.som.sequential import SequentialTraining
from actum.som.together import Together

__all__ = [
    "BatchTraining",
    "Codebook",
    "Report",
    "Schedule",
    "SequentialTraining",
    "Som",
    "Steps",
    "Together",
    "adapt_in_numpy",
]
