"""Takes that are counted along, as the page and `actum record --times` do it: does each end by itself, and rightly?"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle, islice

import numpy as np
from benchmarks.originals import original
from numpy.typing import NDArray

from actum.messages import Skeleton, Truth
from actum.node import SECOND_NS, Counters
from actum.skeletons import INDEX
from actum_examples.cutting.counting import RepetitionCounter
from scene_simulator.driven_simulator import DrivenSimulator
from scene_simulator.programme import ACTIONS
from scene_simulator.settings import Settings

from . import postures
from .postures import Array, Spans

Seen = tuple[list[Skeleton], list[int]]
"""A stream of a gesture, and its action points (ns)."""

PATIENCE_S = 30
"""How long a take may go on after the last repetition."""
ASKED = 5
START_S = 4.0
LATE_S = 25.0
STILL_S = 40.0
SAME_M = 0.08
"""Still stretches of one person are joined where their mean postures differ by less at each such joint."""
GREY_NOISE = 4.0
SWAY_PX = 3.0
WEBCAM_HZ = 20
WEBCAM_STILL_S = 20
WEBCAM_PAUSE_S = 1.5
WEBCAM_PEOPLE = {"development": ("1", "3", "5"), "held-out": ("2", "4", "6")}


@dataclass(frozen=True)
class Take:
    """What became of a take: whether it ended by itself, how many examples it has, and whether these are right.

    Attributes:
        late_s: from the last repetition to its end.
    """

    asked: int
    true: int
    ended: bool
    kept: int
    right: bool
    late_s: float


def take_of(skeletons: Iterable[Skeleton], truths_ns: Spans, asked: int) -> Take:
    """Count a stream along until the take ends by itself or the stream does, and cut it."""
    counter, newest_ns, ended = RepetitionCounter(asked), 0, False
    for skeleton in skeletons:
        newest_ns = skeleton.stamp_ns
        if counter.receive(skeleton) and counter.finished:
            ended = True
            break
    cuts = counter.cuts()
    found = [(each.start_ns, each.end_ns) for each in cuts.repetitions] if cuts else []
    middles = [(start + end) // 2 for start, end in truths_ns]
    held = [sum(start <= middle <= end for middle in middles) for start, end in found]
    last_ns = truths_ns[-1][1] if truths_ns else newest_ns
    right = held.count(1) == len(held) == len(middles)
    return Take(asked, len(middles), ended, len(found), right, (newest_ns - last_ns) / SECOND_NS)


def driven(people: str, actions: Sequence[str], asked: int, wait_s: float) -> Iterator[Take]:
    """The simulated person, who stands for a while and then does what is asked for, as the page's button has it."""
    for actor in postures.ACTORS[people]:
        for action in actions:
            frames, truths_ns = performed(actor, action, asked, wait_s)
            yield take_of(frames, truths_ns, asked)


def performed(actor: int, action: str, times: int, wait_s: float) -> tuple[list[Skeleton], Spans]:
    """Return the skeletons of one performance and where its actions lie; without an action, of standing still."""
    simulator = DrivenSimulator(Settings(driven=True, actor=actor, seed=actor, image_hz=0), SECOND_NS)
    perform = simulator.commands[0]
    frames: list[Skeleton] = []
    marks_ns: list[int] = []
    for messages in simulator.frames():
        frames += [message for message in messages if isinstance(message, Skeleton)]
        marks_ns += [message.stamp_ns for message in messages if isinstance(message, Truth)]
        passed_s = (frames[-1].stamp_ns - frames[0].stamp_ns) / SECOND_NS
        if len(frames) == round(wait_s * 30) and action:
            perform.obey({"actions": [action] * times, "object_id": 1})
        over = bool(action) and len(marks_ns) == 2 * times
        done = over and frames[-1].stamp_ns - marks_ns[-1] > PATIENCE_S * SECOND_NS
        if done if action else passed_s > wait_s:
            return frames, list(zip(marks_ns[::2], marks_ns[1::2], strict=True))
    raise AssertionError("the driven scene has no end")


def still_simulated(people: str) -> Iterator[Take]:
    """The simulated person, who stands and sways; five repetitions are asked for."""
    for actor in postures.ACTORS[people]:
        yield take_of(performed(actor, "", 0, STILL_S)[0], (), ASKED)


def still_kinect(people: str, asked: int = ASKED) -> Iterator[Take]:
    """People of MSRC-12 in their still moments, joined to and fro."""
    for stills, _ in standing(people).values():
        yield take_of(postures.skeletons_of(postures.joined(stills, STILL_S), SECOND_NS), (), asked)


def late_kinect(people: str) -> Iterator[Take]:
    """The same people stand still before and after one of their streams of a gesture, and are asked for its number."""
    for stills, (seen, points_ns) in standing(people).values():
        frames = [frame for frame in seen if postures.is_whole(frame)]
        before, after = postures.joints_of(frames[:1])[0], postures.joints_of(frames[-1:])[0]
        lead = postures.skeletons_of(postures.placed(postures.joined(stills, LATE_S), before, -1), SECOND_NS)
        shift_ns = lead[-1].stamp_ns + SECOND_NS // 2 - frames[0].stamp_ns
        middle = [renewed(frame, frame.stamp_ns + shift_ns) for frame in frames]
        tail = postures.skeletons_of(
            postures.placed(postures.joined(stills, PATIENCE_S), after, 0), middle[-1].stamp_ns + SECOND_NS // 2
        )
        spans_ns = [(point + shift_ns, point + shift_ns) for point in points_ns]
        yield take_of([*lead, *middle, *tail], spans_ns, len(points_ns))


def standing(people: str) -> dict[str, tuple[list[Array], Seen]]:
    """Return the still stretches of each person, and one of their streams with ten points."""
    found: dict[str, tuple[list[Array], list[Seen]]] = {}
    for take, points_ns in postures.gestures(people):
        stills, streams = found.setdefault(take.person, ([], []))
        stills += postures.still_stretches(postures.joints_of(take.frames))
        streams.append((take.frames, points_ns))
    return {
        person: (alike(stills), max(streams, key=lambda each: len(each[1]) == 2 * ASKED))
        for person, (stills, streams) in found.items()
        if stills
    }


def alike(stills: list[Array]) -> list[Array]:
    """Return the longest still stretch, and up to four others of about the same posture."""
    longest_first = sorted(stills, key=lambda still: -len(still))
    means = [(still - still[:, INDEX["torso"]][:, None]).mean(axis=0)[postures.ABOVE_HIPS] for still in longest_first]
    near = [np.linalg.norm(mean - means[0], axis=1).max() < SAME_M for mean in means]
    return [still for still, is_near in zip(longest_first, near, strict=True) if is_near][:ASKED]


def renewed(frame: Skeleton, stamp_ns: int) -> Skeleton:
    agent = frame.agents[0].model_copy(update={"agent": 1})
    return frame.model_copy(update={"stamp_ns": stamp_ns, "session_id": "composed", "seq": None, "agents": [agent]})


def webcam(people: str, moves: bool) -> Iterator[Take]:
    """Florence's people through the pose model: they stand, grey levels are noisy, and the picture sways."""
    for person in WEBCAM_PEOPLE[people]:
        pictures, truths = waved(person, moves)
        stamps_ns = [SECOND_NS + number * SECOND_NS // WEBCAM_HZ for number in range(len(pictures))]
        spans = [(stamps_ns[first], stamps_ns[last]) for first, last in truths]
        yield take_of(perceived(pictures, stamps_ns), spans, ASKED)


def waved(person: str, moves: bool) -> tuple[list[NDArray[np.uint8]], list[tuple[int, int]]]:
    """Return the pictures of standing, then of five waves with pauses where the person moves; and the waves' frames."""

    from sensor_gateway.devices.video import pictures_of

    files = sorted(original("florence3d_rgb").glob(f"*actor{person}id*category1.mp4"))
    clips = [[picture.image_bgr for picture in pictures_of(file)] for file in files]
    pictures, truths = [clips[0][0]] * (WEBCAM_STILL_S * WEBCAM_HZ), list[tuple[int, int]]()
    for clip in islice(cycle(clips), ASKED if moves else 0):
        truths.append((len(pictures), len(pictures) + len(clip) - 1))
        pictures += [*clip, *[clip[-1]] * 4, *[clips[0][0]] * round(WEBCAM_PAUSE_S * WEBCAM_HZ)]
    return pictures + [clips[0][0]] * (10 * WEBCAM_HZ if moves else 0), truths


def perceived(pictures: Sequence[NDArray[np.uint8]], stamps_ns: Sequence[int]) -> Iterator[Skeleton]:
    """Yield the skeletons that the gateway would find in pictures of a webcam."""
    import cv2

    from sensor_gateway.cameras import estimator_of, optics_of
    from sensor_gateway.captured_picture import Picture
    from sensor_gateway.perceiver import Perceiver
    from sensor_gateway.settings import Settings as GatewaySettings

    settings, rng = GatewaySettings(people=1), np.random.default_rng(0)
    with estimator_of(settings) as estimator:
        perceiver = Perceiver(estimator, optics_of(settings), "kinect0", "webcam", Counters())
        for picture, stamp_ns in zip(pictures, stamps_ns, strict=True):
            time_s = stamp_ns / SECOND_NS
            shift = SWAY_PX * np.array([np.sin(1.7 * time_s), 0.4 * np.sin(2.9 * time_s)])
            swayed = cv2.warpAffine(
                picture, np.c_[np.eye(2), shift], picture.shape[1::-1], borderMode=cv2.BORDER_REPLICATE
            )
            noisy = np.clip(swayed + rng.normal(0, GREY_NOISE, picture.shape), 0, 255).astype(np.uint8)
            yield perceiver.skeleton(Picture(noisy, stamp_ns))


def slow(people: str) -> Iterator[Take]:
    """MSR-Action3D at a third of its tempo, held for a second in the middle of each, five with pauses."""
    for number, ((_, _), parts) in enumerate(sorted(postures.by_person_and_action(people).items())[::3]):
        rng = np.random.default_rng(number)
        chain: list[tuple[Array, bool]] = []
        for part in islice(cycle(parts), ASKED):
            slower = postures.stretched(part, 3 * rng.uniform(*postures.TEMPO))
            middle = np.repeat(slower[len(slower) // 2][None], postures.RATE_HZ, axis=0)
            held = np.concatenate([slower[: len(slower) // 2], middle, slower[len(slower) // 2 :]])
            chain += [(postures.paused(part, rng), False), (held, True)]
        chain.append((np.repeat(parts[0][:1], PATIENCE_S * postures.RATE_HZ, axis=0), False))
        yield take_of(*postures.composed_of(chain, rng), ASKED)


TAKES: dict[str, Callable[[str], Iterator[Take]]] = {
    "nobody moves, simulated": still_simulated,
    "nobody moves, Kinect (MSRC-12)": still_kinect,
    "nobody moves, one asked, Kinect (MSRC-12)": lambda people: still_kinect(people, 1),
    "nobody moves, webcam (Florence)": lambda people: webcam(people, moves=False),
    "start after 25 s, simulated": lambda people: driven(people, ACTIONS, ASKED, LATE_S),
    "start after 25 s, Kinect (MSRC-12)": late_kinect,
    "start after 20 s, webcam (Florence), waves": lambda people: webcam(people, moves=True),
    "slow, with holds (MSR-Action3D)": slow,
    "pull and point, driven live": lambda people: driven(people, ("pull", "point"), ASKED, START_S),
    "push, put and lift, driven live": lambda people: driven(people, ("push", "put", "lift"), ASKED, START_S),
    "each once, driven live": lambda people: driven(people, ACTIONS, 1, START_S),
}


def row(name: str, takes: Sequence[Take]) -> str:
    """Return the row of the page."""
    right = sum(take.ended and take.right and take.true > 0 for take in takes)
    done = [take for take in takes if take.true]
    late_s = f"{np.median([take.late_s for take in done if take.ended]):.1f}" if any(t.ended for t in done) else ""
    kept = sum(take.kept for take in takes if not take.true)
    return (
        f"| {name} | {len(takes)} | {sum(take.ended for take in takes)} | {right if done else ''} "
        f"| {kept if len(done) < len(takes) else ''} | {late_s} |"
    )
