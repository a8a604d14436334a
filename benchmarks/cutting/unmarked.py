"""Streams of repetitions that nobody has marked: are all of them cut, and nothing else?"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle, islice

import numpy as np
from benchmarks.originals import original

from actum.messages import Skeleton
from actum_dataset_importer import utkinect
from actum_examples.cutting.courses import PersonTracks
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts, cut
from actum_model_trainer.evaluation import wilson_interval
from scene_simulator.programme import ACTIONS, Task
from scene_simulator.simulator import Simulator

from . import postures
from .postures import Array, Spans

FEWEST_POINTS = 3


@dataclass(frozen=True)
class Result:
    """What came of one stream: whether every repetition was cut exactly once and nothing else was."""

    right: int
    cut: int
    true: int
    sureness: float
    overlaps: tuple[float, ...] = ()
    warned: bool = False

    @property
    def exact(self) -> bool:
        return self.right == self.cut == self.true


def by_points(skeletons: Iterable[Skeleton], points_ns: Sequence[int]) -> Iterator[Result]:
    """Cut a stream, told the number and not told, and count the cuts that hold exactly one action point."""
    for cuts in cuts_of(skeletons, len(points_ns)):
        spans_ns = [(each.start_ns, each.end_ns) for each in (cuts.repetitions if cuts else ())]
        held = [sum(start <= point <= end for point in points_ns) for start, end in spans_ns]
        yield Result(held.count(1), len(held), len(points_ns), cuts.sureness if cuts else 0.0, (), warns(cuts))


def by_bounds(skeletons: Iterable[Skeleton], truths_ns: Spans) -> Iterator[Result]:
    """Cut a stream, told the number and not told, and count the cuts that hold the middle of exactly one repetition."""
    middles = [(start + end) // 2 for start, end in truths_ns]
    for cuts in cuts_of(skeletons, len(truths_ns)):
        found = [(each.start_ns, each.end_ns) for each in (cuts.repetitions if cuts else ())]
        overlaps = []
        for start, end in found:
            inside = [truth for truth, middle in zip(truths_ns, middles, strict=True) if start <= middle <= end]
            if len(inside) == 1:
                shared = min(end, inside[0][1]) - max(start, inside[0][0])
                overlaps.append(shared / (max(end, inside[0][1]) - min(start, inside[0][0])))
        sureness = cuts.sureness if cuts else 0.0
        yield Result(len(overlaps), len(found), len(truths_ns), sureness, tuple(overlaps), warns(cuts))


def warns(cuts: Cuts | None) -> bool:
    """Tell whether it is said that the number of repetitions may be wrong."""
    return cuts is not None and any(doubt.repetition is None for doubt in cuts.doubted)


def cuts_of(skeletons: Iterable[Skeleton], number: int) -> list[Cuts | None]:
    """Return what is cut where the number is told, and where it is not."""
    tracks, first_ns = PersonTracks(), 0
    for skeleton in skeletons:
        first_ns = first_ns or skeleton.stamp_ns
        tracks.receive(skeleton)
    courses = tracks.courses()
    return [cut(courses, asked, first_ns) for asked in (number, None)]


def natural(people: str) -> Iterator[Iterator[Result]]:
    """MSRC-12 as it is: one gesture about ten times in each file."""
    for take, points_ns in postures.gestures(people):
        if len(points_ns) >= FEWEST_POINTS and any(frame.agents for frame in take.frames):
            yield by_points(take.frames, points_ns)


def composed(people: str, disturbed: bool) -> Iterator[Iterator[Result]]:
    """MSR-Action3D: five executions by one person with pauses; disturbed, with walks about it and another action."""
    executions = postures.by_person_and_action(people)
    walks = [postures.centred(postures.joints_of(part)) for part in walks_of(people)]
    for number, ((person, action), parts) in enumerate(sorted(executions.items())):
        rng = np.random.default_rng(number)
        others = [other for (who, what), other in sorted(executions.items()) if who == person and what != action]
        chain: list[tuple[Array, bool]] = []
        for index, part in enumerate(islice(cycle(parts), postures.REPETITIONS)):
            if disturbed and index == 2:
                chain += [(postures.paused(part, rng), False), (others[number % len(others)][0], False)]
            chain.append((postures.paused(part, rng), False))
            chain.append((postures.stretched(part, rng.uniform(*postures.TEMPO)), True))
        chain.append((postures.paused(parts[0], rng), False))
        if disturbed:
            walk = walks[number % len(walks)]
            chain = [(walk, False), *chain, (walk[::-1], False)]
        yield by_bounds(*postures.composed_of(chain, rng))


def scene(people: str) -> Iterator[Iterator[Result]]:
    """The simulated scene: each action five times by each of some people; the marks are the scene's."""
    for actor in postures.ACTORS[people]:
        for action in ACTIONS:
            frames, marks_ns = [], []
            for messages in Simulator([Task(action, 1)] * postures.REPETITIONS, actor, actor, image_hz=0).frames():
                for message in messages:
                    if isinstance(message, Skeleton):
                        frames.append(message)
                    else:
                        marks_ns.append(message.stamp_ns)
            truths = list(zip(marks_ns[::2], marks_ns[1::2], strict=True))
            yield by_bounds(frames, truths)


def walks_of(people: str) -> Iterator[list[Skeleton]]:
    """Yield the labelled walks of UTKinect."""
    folder = original("utkinect")
    labels = utkinect.read_labels(folder)
    for path in utkinect.recording_files(folder):
        take = utkinect.read_labelled(path, "kinect0", labels)
        marks = {mark.kind: mark.stamp_ns or 0 for mark in take.marks if mark.segment_id.endswith("walk")}
        if marks and postures.chosen("msr", take.person, people):
            yield [frame for frame in take.frames if marks["start"] <= frame.stamp_ns <= marks["end"]]


SETS = {
    "MSRC-12, as it is": natural,
    "MSR-Action3D, five with pauses": lambda people: composed(people, disturbed=False),
    "the same, walking up and back, another action between": lambda people: composed(people, disturbed=True),
    "simulated scene, five without pauses": scene,
}


def row(name: str, number: str, results: Sequence[Result]) -> str:
    right, found, true = (sum(counts) for counts in zip(*((r.right, r.cut, r.true) for r in results), strict=True))
    exact, sure = sum(r.exact for r in results), [r.exact for r in results if r.sureness > OTHER_NUMBER]
    low, high = wilson_interval(exact, len(results))
    warned = [r for r in results if r.warned]
    overlaps = [overlap for r in results for overlap in r.overlaps]
    return (
        f"| {name} | {number} | {len(results)} | {exact / len(results):.1%} ({low:.0%}–{high:.0%}) "
        f"| {right / true:.1%} | {right / found:.1%} | {np.median(overlaps) if overlaps else float('nan'):.2f} "
        f"| {sum(sure)} of {len(sure)} | {sum(not r.exact for r in warned)} of {len(warned)} |"
    )
