"""Real people in video clips: seen by the camera source, recognised by what learnt from the others.

ACTUM_DATA=… ACTUM_POSE_MODEL=… python -m benchmarks.camera
"""

import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..originals import ImportedSets
from ..page import versions_of
from ..recognition.datasets import Example, examples_of
from ..recognition.ours import OURS, PAPERS
from ..recognition.peers import DTW, MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, Recogniser
from ..recognition.scores import Score, percent, table
from ..recognition.splits import SEED, Split, leave_one_person_out
from ..recognition.videos import import_florence

PAGE = Path(__file__).with_name("results.md")
RECOGNISERS: tuple[Recogniser, ...] = (OURS, PAPERS, MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, DTW)


def main() -> None:
    began_s = time.perf_counter()
    with tempfile.TemporaryDirectory() as imported:
        examples = examples_of(ImportedSets(Path(imported)).recordings("florence3d_rgb", import_florence, _show))
        imported_s = time.perf_counter() - began_s
        page = "\n\n".join([*_header(examples, imported_s), *_results(examples)])
    print(page)
    PAGE.write_text(page + "\n")


def _show(done: int, total: int) -> None:
    print(f"\r{done} of {total} clips", end="" if done < total else "\n", file=sys.stderr, flush=True)


def _header(examples: Sequence[Example], imported_s: float) -> Iterator[str]:
    people = sorted({example.person for example in examples})
    frames = sum(len(example.sample.stamps_ns) for example in examples)
    versions = versions_of("mediapipe", "numpy", "aeon", "scikit-learn")
    yield "# Recognition from an ordinary camera"
    yield f"""`make bench-camera`: {versions}. RGB clips of Florence 3D Actions:
{len(examples)} clips, {frames} frames, {len({e.label for e in examples})} actions, people {_listed(people)}. Each clip
is seen by the camera source: MediaPipe's pose landmarker, placed in metres by an assumed field of view, no stature
given; {frames / imported_s:.0f} frames/s with decoding. The whole clip is one segment. Every model has seed {SEED}."""
    yield """Each person is tested by what learnt from the others; answers pooled. The peers get the same 15 joints,
with bones of standard length, from the middle of the hips in camera axes, or our upright postures. These people
are not wholly unseen: how landmarks become joints was chosen on them, and how far samples are shown leaning, and
that left-handed actions are mirrored only where people keep to one hand came from their mistakes. The rest of the
preset was chosen on other data."""


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))


def _results(examples: Sequence[Example]) -> Iterator[str]:
    splits = list(leave_one_person_out(examples))
    answers = {recogniser.name: _answers(recogniser, splits) for recogniser in RECOGNISERS}
    tests = [split.test for split in splits]
    yield table(
        ("recogniser", "accuracy %", "right", "95 % interval", *(f"person {test[0].person}" for test in tests)),
        (_row(name, own, tests) for name, own in answers.items()),
    )
    yield f"Confusions of {OURS.name}:"
    yield table(("done", "answered", "times"), _confusions(answers[OURS.name], tests))


def _answers(recogniser: Recogniser, splits: Sequence[Split]) -> list[list[str]]:
    return [recogniser.fit(split.training).labels(split.test) for split in splits]


def _row(name: str, answers: Sequence[Sequence[str]], tests: Sequence[Sequence[Example]]) -> list[str]:
    scores = [Score.of(own, test) for own, test in zip(answers, tests, strict=True)]
    return [name, *sum(scores, Score(0, 0)).cells, *(percent(score.share) for score in scores)]


def _confusions(answers: Sequence[Sequence[str]], tests: Sequence[Sequence[Example]]) -> Iterator[list[str]]:
    pairs = [(e.label, a) for own, test in zip(answers, tests, strict=True) for a, e in zip(own, test, strict=True)]
    wrong = [pair for pair in pairs if pair[0] != pair[1]]
    for done, answered in sorted(set(wrong), key=lambda pair: (-wrong.count(pair), pair)):
        yield [done, answered, str(wrong.count((done, answered)))]


if __name__ == "__main__":
    main()
