"""Errors over all development sets, and how many there are for each of the best peer's."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from actum_model_trainer.evaluation import wilson_interval

from .bench import Bench
from .development import DevelopmentSet, development_sets, said_of_videos
from .ours import OURS
from .peers import DTW, MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, Recogniser
from .scores import Floats, percent, table
from .splits import SEED

PEERS: tuple[Recogniser, ...] = (MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, DTW)
RESAMPLES = 5000
HALF_ERROR = 0.5
"""Added to each count of errors, so that a resample without any has a ratio."""


@dataclass(frozen=True)
class Errors:
    """What one set gave.

    Attributes:
        wrong: how often each recogniser (row) was wrong about each sequence (column).
        asked: how often each sequence was tested.
    """

    of: DevelopmentSet
    wrong: Floats
    asked: Floats

    @property
    def best_peer(self) -> int:
        """The row of the peer with the fewest errors, the first of equals; ours is row 0."""
        return 1 + int(self.wrong[1:].sum(axis=1).argmin())

    def log_ratio(self, times: Floats) -> Floats:
        """Return log (ours / the best peer's) with each sequence counted so many times, (…, sequences)."""
        counts = times @ self.wrong[[0, self.best_peer]].T + HALF_ERROR
        ratio: Floats = np.log(counts[..., 0] / counts[..., 1])
        return ratio


def errors_over_sets(bench: Bench) -> Iterator[str]:
    """Count the errors of each recogniser on each set."""
    measured = [_measured(bench, each) for each in development_sets(bench.data)]
    protocols = "; ".join(f"{own.of.name}, {own.of.protocol}" for own in measured)
    yield f"""{protocols}.{said_of_videos()} Errors of so many answers, in brackets their share (%) with
Wilson's 95 % interval, as if sequences were independent, where one that is tested in several draws counts once."""
    names = [recogniser.name for recogniser in (OURS, *PEERS)]
    rows = ([name, *(_cell(own, row) for own in measured)] for row, name in enumerate(names))
    yield table(("recogniser", *(own.of.name for own in measured)), rows)
    yield f"""Our errors divided by those of the peer with the fewest on that set, half an error added to each count.
The 95 % intervals come from {RESAMPLES} resamples of each set's test sequences, the same for both; which peer is
the best is not drawn anew. Under 1 ours makes fewer."""
    yield table(("set", "best peer", "ours / best peer", "95 % interval"), _ratio_rows(measured, names))


def _measured(bench: Bench, development: DevelopmentSet) -> Errors:
    number = {example: i for i, example in enumerate(development.examples)}
    wrong, asked = np.zeros((1 + len(PEERS), len(number))), np.zeros(len(number))
    for split in development.splits:
        at = [number[example] for example in split.test]
        asked[at] += 1
        for row, recogniser in enumerate((OURS, *PEERS)):
            answers = bench.fitted(recogniser, split.training).labels(split.test)
            wrong[row, at] += [answer != example.label for answer, example in zip(answers, split.test, strict=True)]
    return Errors(development, wrong, asked)


def _cell(own: Errors, row: int) -> str:
    wrong, asked, sequences = own.wrong[row].sum(), own.asked.sum(), int(np.count_nonzero(own.asked))
    low, high = wilson_interval(round(sequences * wrong / asked), sequences)
    return f"{wrong:.0f} of {asked:.0f} ({percent(wrong / asked)}; {percent(low)}–{percent(high)})"


def _ratio_rows(measured: Sequence[Errors], names: Sequence[str]) -> Iterator[list[str]]:
    rng = np.random.default_rng(SEED)
    seen = [own.log_ratio(np.ones(len(own.asked))) for own in measured]
    resampled = [own.log_ratio(_times(len(own.asked), rng)) for own in measured]
    for own, at, drawn in zip(measured, seen, resampled, strict=True):
        yield [own.of.name, names[own.best_peer], *_ratio_cells(float(at), drawn)]
    yield ["geometric mean", "", *_ratio_cells(float(np.mean(seen)), np.mean(resampled, axis=0))]


def _times(sequences: int, rng: np.random.Generator) -> Floats:
    """Draw how often each sequence is in each resample."""
    return rng.multinomial(sequences, np.full(sequences, 1 / sequences), size=RESAMPLES)


def _ratio_cells(log_ratio: float, resampled: Floats) -> list[str]:
    low, high = np.exp(np.quantile(resampled, (0.025, 0.975)))
    return [f"{np.exp(log_ratio):.2f}", f"{low:.2f}–{high:.2f}"]
