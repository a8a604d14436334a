"""Any body, any camera: trained on recordings as they are, tested on changed ones."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from actum.recording import Recording
from actum_model_trainer.sample_reading import samples_from

from .bench import Bench
from .changes import Change, Changed, childlike, dropped, mirrored, pitched, seated, turned
from .datasets import Example, with_joints
from .ours import OURS
from .peers import DTW, MINIROCKET, MINIROCKET_UPRIGHT, Fitted, Recogniser
from .scores import Floats, percent, table
from .splits import Split, by_people, odd_even

RECOGNISERS: tuple[Recogniser, ...] = (OURS, MINIROCKET, MINIROCKET_UPRIGHT, DTW)
FRAMES_PER_SECOND = 15
"""Of both sets."""

NOT_SEATED = frozenset(
    ("bend", "forward kick", "side kick", "jogging", "pickup & throw", "walk", "sitDown", "standUp", "pickUp", "carry")
)
"""Actions that nobody does sitting down."""

SEATED = "seated"
CHANGES: Mapping[str, Change] = {
    "turned by 60° to the right": Change(turned(60)),
    "by 60° to the left": Change(turned(-60)),
    "by 90° to the right": Change(turned(90)),
    "by 90° to the left": Change(turned(-90)),
    SEATED: Change(seated),
    "a child's proportions": Change(childlike),
    "mirror image": Change(mirrored),
    "at half the speed": Change(pace=0.5, frames_per_second=FRAMES_PER_SECOND),
    "at twice the speed": Change(pace=2.0, frames_per_second=FRAMES_PER_SECOND),
    "camera pitched down by 20°": Change(pitched(20)),
    "up by 20°": Change(pitched(-20)),
    "15 frames/s": Change(frames_per_second=15),
    "30 frames/s": Change(frames_per_second=30),
    "60 frames/s": Change(frames_per_second=60),
    "10 % of joints missing": Change(dropped(0.1)),
    "30 % of joints missing": Change(dropped(0.3)),
}


@dataclass(frozen=True)
class Trained:
    """Recognisers of the same people, and the recordings of others."""

    fitted: Sequence[Fitted]
    test: Sequence[Example]
    recordings: Sequence[Recording]

    def right(self, change: Change) -> Floats:
        """Tell which recogniser (row) is right about which sequence (column); never about one that is lost."""
        changed = [Changed(recording, change) for recording in self.recordings]
        examples = with_joints(samples_from(changed).usable, changed)
        place = {_name(example): i for i, example in enumerate(self.test)}
        right = np.zeros((len(self.fitted), len(self.test)), dtype=bool)
        for row, fitted in enumerate(self.fitted):
            for example, answer in zip(examples, fitted.labels(examples), strict=True):
                right[row, place[_name(example)]] = answer == example.label
        return right


def bodies(bench: Bench) -> Iterator[str]:
    """What is lost on people and cameras that the training did not see."""
    yield f"""The changes are synthetic: calculated on the joints of the sensor's skeletons, before everything that
runs live; they are no recordings of such people or cameras. Nothing is hidden by a turn, nobody moves otherwise for
sitting, and a child is only built differently. Everybody gets bones of standard length, so that proportions can matter
to nobody but for what is rejected. Trained on recordings as they are; accuracy (%) on those of other people, and its
change in points where these are changed, beside the same sequences unchanged; one that is lost counts as wrong.
"Seated" leaves out what nobody does so: {", ".join(sorted(NOT_SEATED))}. Turned: about the vertical through the
person, as though the camera stood elsewhere. Pitched: the whole scene, and nobody is told. Half and twice the speed,
and frames at other rates, are interpolated between the sensor's frames; MSR's come 15 times a second, UTKinect's mostly
every 0.07 to 0.2 s. Missing joints: each of each frame at random; missing for ours, interpolated over time for the
peers, for MiniRocket on our upright postures after these were made."""
    msr, utkinect = odd_even(bench.data.msr), bench.data.utkinect
    yield _table(bench, "MSR Action3D, odd people trained, even tested", bench.data.msr_recordings, [msr])
    folds = [odd_even(utkinect), by_people(utkinect, {2, 4, 6, 8, 10})]
    yield _table(bench, "UTKinect, odd and even people trained in turn", bench.data.utkinect_recordings, folds)


def _table(bench: Bench, title: str, recordings: Sequence[Recording], splits: Sequence[Split]) -> str:
    trained = [_trained(bench, split, recordings) for split in splits]
    can_sit = np.array([example.label not in NOT_SEATED for own in trained for example in own.test])
    before = _right(trained, Change())
    rows = [["unchanged, accuracy", str(len(can_sit)), *(percent(own.mean()) for own in before)]]
    for name, change in CHANGES.items():
        counted = can_sit if name == SEATED else np.ones(len(can_sit), dtype=bool)
        gains = 100 * (_right(trained, change)[:, counted].mean(axis=1) - before[:, counted].mean(axis=1))
        rows.append([name, str(counted.sum()), *(f"{gain:+.1f}" for gain in gains)])
    return table((title, "sequences", *(recogniser.name for recogniser in RECOGNISERS)), rows)


def _trained(bench: Bench, split: Split, recordings: Sequence[Recording]) -> Trained:
    people = {example.person for example in split.test}
    fitted = [bench.fitted(recogniser, split.training) for recogniser in RECOGNISERS]
    return Trained(fitted, split.test, [r for r in recordings if int(r.person) in people])


def _right(trained: Sequence[Trained], change: Change) -> Floats:
    return np.concatenate([own.right(change) for own in trained], axis=1)


def _name(example: Example) -> tuple[str, str]:
    """Tell a sequence from all others: segments are numbered anew in each recording."""
    return example.sample.file, example.name
