"""The repetitions that are cut out of streams nobody has marked, on public recordings, as a page of Markdown.

python -m benchmarks.cutting [--people development|held-out] [--only ROW], by default the people held out; needs
ACTUM_DATA and ACTUM_POSE_MODEL. benchmarks/cutting.md is what it printed.
"""

import argparse
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle, islice

import numpy as np
from benchmarks.originals import original
from numpy.typing import NDArray

from actum.messages import Agent, Segment, Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX, JOINTS
from actum_dataset_importer import msr_action3d, msrc12, utkinect
from actum_dataset_importer.takes import Take
from actum_examples.cutting.courses import PersonTracks
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts, cut
from actum_model_trainer.evaluation import wilson_interval
from scene_simulator.programme import ACTIONS, Task
from scene_simulator.simulator import Simulator

from . import cutting_live

Array = NDArray[np.float64]

RATE_HZ = 15
"""Rate of the composed streams: that of MSR-Action3D."""
REPETITIONS = 5
PAUSE_S = (0.8, 2.0)
BRIDGE_S = 0.4
TEMPO = (0.85, 1.15)
JITTER_M = 0.005
FEWEST_POINTS = 3
SCENE_PEOPLE = {"development": range(20, 24), "held-out": range(40, 48)}
HELD_OUT = {
    "msrc12": ("3", "7", "11", "15", "19", "23", "27"),
    "msr": ("2", "4", "6", "8", "10"),
}
"""Half of the people of each set; nothing was chosen on them."""


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


def by_bounds(skeletons: Iterable[Skeleton], truths_ns: Sequence[tuple[int, int]]) -> Iterator[Result]:
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


def joints_of(frames: Iterable[Skeleton]) -> Array:
    """Return the frames that hold a whole person, (n, 15, 3), metres, torso at the origin's vertical."""
    whole = [f.agents[0].joints for f in frames if f.agents and None not in f.agents[0].joints]
    joints = np.array(whole, dtype=np.float64).reshape(-1, len(JOINTS), 3)
    torso = joints[:1, INDEX["torso"]]
    moved: Array = joints - [torso[0, 0], torso[0, 1], torso[0, 2] - 2.5] if len(joints) else joints
    return moved


def skeletons_of(joints: Array) -> list[Skeleton]:
    return [
        Skeleton(
            stamp_ns=SECOND_NS + i * SECOND_NS // RATE_HZ,
            sensor="kinect0",
            agents=[Agent(agent=1, joints=frame.tolist(), confidence=[1.0] * len(JOINTS))],
            session_id="composed",
        )
        for i, frame in enumerate(joints)
    ]


def bridged(parts: Sequence[Array]) -> tuple[Array, list[tuple[int, int]]]:
    """Join parts by straight ways from the end of one to the start of the next; and where each lies."""
    joined, bounds = [], []
    for index, part in enumerate(parts):
        if index:
            share = np.linspace(0, 1, round(BRIDGE_S * RATE_HZ) + 2)[1:-1, None, None]
            joined.append((1 - share) * joined[-1][-1] + share * part[0])
        first = sum(map(len, joined))
        joined.append(part)
        bounds.append((first, first + len(part) - 1))
    return np.concatenate(joined), bounds


def stretched(part: Array, factor: float) -> Array:
    """Take a part at another tempo."""
    times = np.linspace(0, len(part) - 1, max(4, round(len(part) * factor)))
    before = np.minimum(times.astype(int), len(part) - 2)
    share = (times - before)[:, None, None]
    slower: Array = (1 - share) * part[before] + share * part[before + 1]
    return slower


def natural(people: str) -> Iterator[Iterator[Result]]:
    """MSRC-12 as it is: one gesture about ten times in each file."""
    for path, name in msrc12.stream_names(original("msrc12")):
        take = msrc12.read_stream(path, name, "kinect0")
        points_ns = [int(point) * 1000 for point in msrc12.stored_stream(path, name).points_us]
        if chosen("msrc12", take.person, people) and len(points_ns) >= FEWEST_POINTS and seen(take):
            yield by_points(take.frames, points_ns)


def composed(people: str, disturbed: bool) -> Iterator[Iterator[Result]]:
    """MSR-Action3D: five executions by one person with pauses; disturbed, with walks about it and another action."""
    executions = by_person_and_action(people)
    walks = [joints_of(part) for part in walks_of(people)]
    for number, ((person, action), parts) in enumerate(sorted(executions.items())):
        rng = np.random.default_rng(number)
        others = [other for (who, what), other in sorted(executions.items()) if who == person and what != action]
        chain: list[tuple[Array, bool]] = []
        for index, part in enumerate(islice(cycle(parts), REPETITIONS)):
            if disturbed and index == 2:
                chain += [(paused(part, rng), False), (others[number % len(others)][0], False)]
            chain += [(paused(part, rng), False), (stretched(part, rng.uniform(*TEMPO)), True)]
        chain.append((paused(parts[0], rng), False))
        if disturbed:
            walk = walks[number % len(walks)]
            chain = [(walk, False), *chain, (walk[::-1], False)]
        joints, bounds = bridged([part for part, _ in chain])
        skeletons = skeletons_of(joints + rng.normal(0, JITTER_M, joints.shape))
        stamps = [frame.stamp_ns for frame in skeletons]
        truths = [(stamps[a], stamps[b]) for (a, b), (_, true) in zip(bounds, chain, strict=True) if true]
        yield by_bounds(skeletons, truths)


def scene(people: str) -> Iterator[Iterator[Result]]:
    """The simulated scene: each action five times by each of some people; the marks are the scene's."""
    for actor in SCENE_PEOPLE[people]:
        for action in ACTIONS:
            frames, marks_ns = [], []
            for messages in Simulator([Task(action, 1)] * REPETITIONS, actor, actor, image_hz=0).frames():
                for message in messages:
                    if isinstance(message, Skeleton):
                        frames.append(message)
                    else:
                        marks_ns.append(message.stamp_ns)
            truths = list(zip(marks_ns[::2], marks_ns[1::2], strict=True))
            yield by_bounds(frames, truths)


def by_person_and_action(people: str) -> dict[tuple[str, str], list[Array]]:
    executions: dict[tuple[str, str], list[Array]] = {}
    for path in msr_action3d.sequence_files(original("msr_action3d")):
        take = msr_action3d.read_sequence(path, "kinect0")
        if chosen("msr", take.person, people) and "excluded" not in take.metadata:
            executions.setdefault((take.person, take.metadata["action"]), []).append(joints_of(take.frames))
    return executions


def walks_of(people: str) -> Iterator[list[Skeleton]]:
    """Yield the labelled walks of UTKinect."""
    folder = original("utkinect")
    labels = utkinect.read_labels(folder)
    for path in utkinect.recording_files(folder):
        take = utkinect.read_labelled(path, "kinect0", labels)
        marks = {mark.kind: mark.stamp_ns or 0 for mark in take.marks if is_walk(mark)}
        if marks and chosen("msr", take.person, people):
            yield [frame for frame in take.frames if marks["start"] <= frame.stamp_ns <= marks["end"]]


def is_walk(mark: Segment) -> bool:
    return mark.segment_id.endswith("walk")


def paused(part: Array, rng: np.random.Generator) -> Array:
    return np.repeat(part[:1], round(rng.uniform(*PAUSE_S) * RATE_HZ), axis=0)


def seen(take: Take) -> bool:
    return any(frame.agents for frame in take.frames)


def chosen(dataset: str, person: str, people: str) -> bool:
    return (person in HELD_OUT[dataset]) == (people == "held-out")


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


SETS = {
    "MSRC-12, as it is": natural,
    "MSR-Action3D, five with pauses": lambda people: composed(people, disturbed=False),
    "the same, walking up and back, another action between": lambda people: composed(people, disturbed=True),
    "simulated scene, five without pauses": scene,
}


def main() -> None:
    """Measure all sets and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--people", choices=("development", "held-out"), default="held-out")
    parser.add_argument("--only", default="", help="measure the rows whose name contains this")
    told = parser.parse_args()
    print(HEADER.format(people=told.people))
    for name, measure in SETS.items():
        if told.only in name:
            for number, results in zip(("told", "not told"), zip(*measure(told.people), strict=True), strict=True):
                print(row(name, number, results).replace("nan", ""), flush=True)
            print(f"{name}: done", file=sys.stderr, flush=True)
    print(LIVE_HEADER)
    for name, takes in cutting_live.TAKES.items():
        if told.only in name:
            print(cutting_live.row(name, list(takes(told.people))), flush=True)
            print(f"{name}: done", file=sys.stderr, flush=True)


HEADER = """# Repetitions cut without marks

`python -m benchmarks.cutting`, {people} people; one core. What `actum record --times` and `actum label cut` do.

MSRC-12: each file holds one gesture about ten times; a cut is right where it holds exactly one action point. The points
are where the gesture can be recognised, not its bounds; some lie after the movement. MSR-Action3D: the two or three
executions of an action by a person, in turn, at 0.85 to 1.15 times their tempo, with pauses of 0.8 to 2 s and 5 mm of
noise; disturbed, a walk of UTKinect before and after and another action of the person after the second. Scene: five
times the same action on one object; its marks end before the hand goes back, while a cut goes from rest to rest. In
these, a cut is right where it holds the middle of exactly one repetition. Numbers were chosen on the other half of the
people of MSRC-12 (1, 5, 9 and so on) and of MSR-Action3D (those with odd numbers).

*Exact*: every repetition in one cut and no other cut, with Wilson's 95 % interval. IoU: the median over right cuts.
*Sure and exact*: of the streams that the command calls sure, so many are exact.
*Warned and wrong*: of the streams of which it says that the number may be wrong, so many are not exact.

| streams | number | streams | exact | repetitions found | cuts right | IoU | sure and exact | warned and wrong |
|---|---|---:|---|---:|---:|---:|---:|---:|"""
LIVE_HEADER = """
## Takes that are counted along

What the page and `actum record --times` do while somebody acts: a take ends by itself once as many as asked for are
followed by a long rest, and within 30 s of the last one, or not at all. *All right*: it ended by itself, with every
repetition in one cut and no other cut. *Kept*: examples that are kept where nobody moves, after 20 or 40 s.

Simulated: the person of `actum up --driven`, asked by command. Kinect: people of MSRC-12 in their still moments, joined
to and fro, alone or before and after one of their streams. Webcam: the first picture of a clip with 4 grey levels of
noise, swaying by 3 pixels, and waves of the same person, through the pose model. Slow: three times as long as MSR's,
held for a second in the middle.

| takes | takes | ended by themselves | all right | kept | end after the last one (s) |
|---|---:|---:|---:|---:|---:|"""


if __name__ == "__main__":
    main()
