"""How often the answer is right before the action is over."""

from collections.abc import Iterator, Sequence

from .accuracy import pooled
from .bench import Bench
from .ours import OURS, PAPERS
from .peers import MINIROCKET_PREFIXES, MINIROCKET_UPRIGHT_PREFIXES
from .scores import percent, table
from .splits import DRAWS, Split, halves, leave_one_person_out, odd_even

SHARES = tuple(tenth / 10 for tenth in range(1, 11))


def early(bench: Bench) -> Iterator[str]:
    """Accuracy against the share of the action seen."""
    yield """Accuracy (%) after a share of each test sequence's frames, at least three. Nobody is told how much of the
action was seen; ours is told at 100 % that it is over. MiniRocket is trained on the first 20, 40, 60, 80 and 100 % of
each training sequence, each resampled to 32 frames."""
    yield _curves(bench, "MSR Action3D, odd and even people", [odd_even(bench.data.msr)])
    yield _curves(bench, f"MSR Action3D, {DRAWS} draws of five and five people", list(halves(bench.data.msr)))
    yield _curves(bench, "UTKinect, leave one person out", list(leave_one_person_out(bench.data.utkinect)))


def _curves(bench: Bench, title: str, splits: Sequence[Split]) -> str:
    rows = (
        [recogniser.name, *(percent(pooled(bench, recogniser, splits, share).share) for share in SHARES)]
        for recogniser in (OURS, PAPERS, MINIROCKET_PREFIXES, MINIROCKET_UPRIGHT_PREFIXES)
    )
    return table((title, *(f"{share:.0%}" for share in SHARES)), rows)
