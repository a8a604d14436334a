"""What both kinds of streams are put together from: people's postures, joined with pauses and ways between them."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from benchmarks.originals import original
from numpy.typing import NDArray

from actum.messages import Agent, Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX, JOINTS
from actum_dataset_importer import msr_action3d, msrc12
from actum_dataset_importer.takes import Take

Array = NDArray[np.float64]
Spans = Sequence[tuple[int, int]]

RATE_HZ = 15
"""Rate of the composed streams: that of MSR-Action3D."""
REPETITIONS = 5
PAUSE_S = (0.8, 2.0)
BRIDGE_S = 0.4
TEMPO = (0.85, 1.15)
JITTER_M = 0.005
NEAR_M = 0.06
"""A stretch of a recording is still where no joint above the hips gets farther within half a second."""
SHORTEST_STILL_S = 1.5
ABOVE_HIPS = [INDEX[name] for name in JOINTS if not name.endswith(("hip", "knee", "foot"))]
HELD_OUT = {
    "msrc12": ("3", "7", "11", "15", "19", "23", "27"),
    "msr": ("2", "4", "6", "8", "10"),
}
"""Half of the people of each set; nothing was chosen on them."""
ACTORS = {"development": range(20, 24), "held-out": range(40, 48)}
"""The people of the simulated scene."""


def chosen(dataset: str, person: str, people: str) -> bool:
    return (person in HELD_OUT[dataset]) == (people == "held-out")


def gestures(people: str) -> Iterator[tuple[Take, list[int]]]:
    """Yield the streams of MSRC-12 and their action points."""
    for path, name in msrc12.stream_names(original("msrc12")):
        take = msrc12.read_stream(path, name, "kinect0")
        if chosen("msrc12", take.person, people):
            yield take, [int(point) * 1000 for point in msrc12.stored_stream(path, name).points_us]


def is_whole(frame: Skeleton) -> bool:
    return bool(frame.agents) and None not in frame.agents[0].joints


def joints_of(frames: Iterable[Skeleton]) -> Array:
    """Return the frames that hold a whole person, (n, 15, 3), metres."""
    whole = [frame.agents[0].joints for frame in frames if is_whole(frame)]
    return np.array(whole, dtype=np.float64).reshape(-1, len(JOINTS), 3)


def centred(joints: Array) -> Array:
    """Let the torso begin at the origin's vertical."""
    torso = joints[:1, INDEX["torso"]]
    moved: Array = joints - [torso[0, 0], torso[0, 1], torso[0, 2] - 2.5] if len(joints) else joints
    return moved


def skeletons_of(joints: Array, first_ns: int, rate_hz: int = 30) -> list[Skeleton]:
    return [
        Skeleton(
            stamp_ns=first_ns + number * SECOND_NS // rate_hz,
            sensor="kinect0",
            agents=[Agent(agent=1, joints=frame.tolist(), confidence=[1.0] * len(JOINTS))],
            session_id="composed",
        )
        for number, frame in enumerate(joints)
    ]


def by_person_and_action(people: str) -> dict[tuple[str, str], list[Array]]:
    executions: dict[tuple[str, str], list[Array]] = {}
    for path in msr_action3d.sequence_files(original("msr_action3d")):
        take = msr_action3d.read_sequence(path, "kinect0")
        if chosen("msr", take.person, people) and "excluded" not in take.metadata:
            executions.setdefault((take.person, take.metadata["action"]), []).append(centred(joints_of(take.frames)))
    return executions


def composed_of(parts: Sequence[tuple[Array, bool]], rng: np.random.Generator) -> tuple[list[Skeleton], Spans]:
    """Join parts by straight ways, and let the joints tremble; return also when those lie that count."""
    joined, bounds = list[Array](), list[tuple[int, int]]()
    for part, counts in parts:
        if joined:
            joined.append(way(joined[-1][-1], part[0], RATE_HZ))
        first = sum(map(len, joined))
        joined.append(part)
        if counts:
            bounds.append((first, first + len(part) - 1))
    joints = np.concatenate(joined)
    skeletons = skeletons_of(joints + rng.normal(0, JITTER_M, joints.shape), SECOND_NS, RATE_HZ)
    return skeletons, [(skeletons[first].stamp_ns, skeletons[last].stamp_ns) for first, last in bounds]


def way(start: Array, end: Array, rate_hz: int) -> Array:
    """Return the straight way from one posture to another, without both."""
    share = np.linspace(0, 1, round(BRIDGE_S * rate_hz) + 2)[1:-1, None, None]
    between: Array = (1 - share) * start + share * end
    return between


def stretched(part: Array, factor: float) -> Array:
    """Take a part at another tempo."""
    times = np.linspace(0, len(part) - 1, max(4, round(len(part) * factor)))
    before = np.minimum(times.astype(int), len(part) - 2)
    share = (times - before)[:, None, None]
    slower: Array = (1 - share) * part[before] + share * part[before + 1]
    return slower


def paused(part: Array, rng: np.random.Generator) -> Array:
    return np.repeat(part[:1], round(rng.uniform(*PAUSE_S) * RATE_HZ), axis=0)


def still_stretches(joints: Array, rate_hz: int = 30) -> list[Array]:
    """Return the stretches (frames, 15, 3) in which a person hardly moves."""
    lag, reach = rate_hz // 2, rate_hz // 10
    if len(joints) <= 4 * lag:
        return []
    windows = np.lib.stride_tricks.sliding_window_view(joints, 2 * reach + 1, axis=0).mean(axis=3)
    ways_m = np.linalg.norm(windows[lag:] - windows[:-lag], axis=2)[:, ABOVE_HIPS].max(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], ways_m < NEAR_M, [0]])))
    spans = [(start, end + lag) for start, end in zip(edges[::2], edges[1::2], strict=True)]
    return [joints[start:end] for start, end in spans if end - start >= SHORTEST_STILL_S * rate_hz]


def joined(stills: Sequence[Array], seconds: float, rate_hz: int = 30) -> Array:
    """Join still stretches, every other round backwards, to so many seconds, with short ways between them."""
    whole, frames = list[Array](), round(seconds * rate_hz)
    for number in range(frames):
        part = stills[number % len(stills)]
        part = placed(part if number // len(stills) % 2 == 0 else part[::-1], stills[0][0], 0)
        if whole:
            whole.append(way(whole[-1][-1], part[0], rate_hz))
        whole.append(part)
        if sum(map(len, whole)) >= frames:
            break
    return np.concatenate(whole)[:frames]


def placed(part: Array, at: Array, index: int) -> Array:
    """Move a part so that the torso of one of its frames is where another posture has it."""
    moved: Array = part - part[index, INDEX["torso"]] + at[INDEX["torso"]]
    return moved
