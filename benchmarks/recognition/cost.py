"""What learning and answering cost on one core."""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from statistics import median
from typing import Any

from actum_model_trainer.answering import encoded
from som_classifier.kinematics import KinematicsFilter

from .bench import Bench
from .datasets import Example
from .ours import OURS, PAPERS, FittedMaps, Maps
from .peers import MINIROCKET, MULTIROCKET, FittedRocket, Recogniser, Rocket
from .scores import table
from .splits import odd_even

WARM_UP, ASKED = 7, 60


def cost(bench: Bench) -> Iterator[str]:
    """Times of training, of a frame and of a decision."""
    split = odd_even(bench.data.msr)
    yield f"""One core, one thread. Training: {len(split.training)} sequences of 20 actions, from samples in memory to
a model, after a first training has compiled what is compiled. Frame: low-pass and velocity, then what the model keeps
of the frame. Decision: one sequence at a time, whole, or its first half before it is over, right after its frames and
once more; the peers' begins with the joints of all its frames. Medians over {ASKED} test sequences."""
    header = ("recogniser", "training s", "frame µs", "decision, half seen µs", "again µs", "whole µs", "again µs")
    rows = [_maps_row(maps, split.training, split.test[::4][:ASKED]) for maps in (OURS, PAPERS)]
    rows += [_rocket_row(rocket, split.training, split.test[::4][:ASKED]) for rocket in (MINIROCKET, MULTIROCKET)]
    yield table(header, rows)


def _maps_row(maps: Maps, training: Sequence[Example], asked: Sequence[Example]) -> list[str]:
    training_s, fitted = _trained(maps, training)
    frame_us = [time_us for example in asked for time_us in _frame_times_us(fitted, example)]
    half, whole = (_asked_twice_us(partial(_decision_us, fitted, complete=each), asked) for each in (False, True))
    return [maps.name, f"{training_s:.1f}", _us(frame_us), *half, *whole]


def _rocket_row(rocket: Rocket, training: Sequence[Example], asked: Sequence[Example]) -> list[str]:
    training_s, fitted = _trained(rocket, training)
    return [rocket.name, f"{training_s:.1f}", "–", *(
        cell for share in (0.5, 1.0) for cell in _asked_twice_us(partial(_answer_us, fitted, share=share), asked)
    )]  # fmt: skip


def _asked_twice_us(decide: Callable[[Example], Sequence[float]], asked: Sequence[Example]) -> list[str]:
    """Return the medians of the first and of the second time."""
    return [_us(times_us) for times_us in zip(*map(decide, asked), strict=True)]


def _trained(recogniser: Recogniser, training: Sequence[Example]) -> tuple[float, Any]:
    recogniser.fit(training[::WARM_UP])
    time_us, fitted = _timed_us(recogniser.fit, training)
    return time_us / 1e6, fitted


def _frame_times_us(fitted: FittedMaps, example: Example) -> Iterator[float]:
    movement, encoder = KinematicsFilter(), fitted.model.encoder()
    for frame, posture in zip(encoded(fitted.model, example.sample), example.sample.postures, strict=True):
        yield _timed_us(movement.step, frame.stamp_ns, posture)[0] + _timed_us(encoder.encode, frame)[0]


def _decision_us(fitted: FittedMaps, example: Example, complete: bool) -> Sequence[float]:
    frames = encoded(fitted.model, example.sample)
    seen = frames if complete else frames[: max(fitted.model.min_frames, len(frames) // 2)]
    return [_timed_us(fitted.model.recognise, seen, complete)[0] for _ in range(2)]


def _answer_us(fitted: FittedRocket, example: Example, share: float) -> Sequence[float]:
    return [_timed_us(fitted.labels, [example], share)[0] for _ in range(2)]


def _timed_us(work: Callable[..., Any], *arguments: Any) -> tuple[float, Any]:
    """Run once; return how long it took and what it gave."""
    began_s = time.perf_counter()
    result = work(*arguments)
    return (time.perf_counter() - began_s) * 1e6, result


def _us(times_us: Iterable[float]) -> str:
    return f"{median(times_us):,.0f}"
