"""The takes as other people, things and cameras would have given them: what is done, and to what, stays the same.

Each variation changes one thing by an amount; half of the amounts were looked at while the fusion was made, the others
were not.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from benchmarks.bimacs_tracks import Array, Tracks
from numpy.typing import NDArray

from actum.messages import Hand
from actum.node import SECOND_NS

OTHER: Mapping[Hand, Hand] = {"left": "right", "right": "left"}
DOWN = np.array([0.0, 1.0, 0.0])
LIFTED_M, IN_HAND_M = 0.08, 0.20
"""What is this much above where it stands is lifted; what is this near to a hand may be in it."""
QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
FOUND_LATE_S = ((-0.43, -0.20, -0.13, -0.03, 0.07, 0.17, 0.37), (-0.60, -0.13, 0.03, 0.13, 0.20, 0.37, 0.57))
"""By how many seconds the starts and the ends that the classifier finds are late, at these quantiles: of the 70 of 72
pushes, pulls, puts and lifts that it finds in `make bench-objects` where all is plain."""
STANDING = 0
"""The bowl, which stands all the while."""

Change = Callable[..., Tracks]
"""Changes tracks by an amount, with what it draws."""


def mirrored(tracks: Tracks, _: np.random.Generator) -> Tracks:
    flip = np.array([-1.0, 1.0, 1.0])
    return replace(
        tracks,
        hands={OTHER[hand]: flip * path for hand, path in tracks.hands.items()},
        objects={i: flip * path for i, path in tracks.objects.items()},
        actors={name: OTHER[hand] for name, hand in tracks.actors.items()},
    )


def tempo(tracks: Tracks, _: np.random.Generator, factor: float) -> Tracks:
    first = int(tracks.stamps_ns[0])

    def at(stamp_ns: int) -> int:
        return first + round((stamp_ns - first) / factor)

    return replace(
        tracks,
        stamps_ns=np.array([at(int(stamp)) for stamp in tracks.stamps_ns]),
        bounds={name: (at(start), at(end)) for name, (start, end) in tracks.bounds.items()},
    )


def size(tracks: Tracks, _: np.random.Generator, factor: float) -> Tracks:
    """Scale everything: a person, things and ways of another size."""
    return replace(
        tracks,
        hands={hand: factor * path for hand, path in tracks.hands.items()},
        objects={i: factor * path for i, path in tracks.objects.items()},
    )


def hands_elsewhere(tracks: Tracks, rng: np.random.Generator, by_m: float) -> Tracks:
    """Put the hands' markers on another part of the hand, in a direction of each hand's own."""
    return replace(tracks, hands={hand: path + by_m * _direction(rng) for hand, path in tracks.hands.items()})


def objects_elsewhere(tracks: Tracks, rng: np.random.Generator, by_m: float) -> Tracks:
    """Take another point of each object for its middle, which goes round as the object is tilted."""
    return replace(
        tracks,
        objects={i: path + tracks.turned[i] @ (by_m * _direction(rng)) for i, path in tracks.objects.items()},
    )


def noise(tracks: Tracks, rng: np.random.Generator, hands_m: float, objects_m: float) -> Tracks:
    return replace(
        tracks,
        hands={hand: path + rng.normal(0.0, hands_m, path.shape) for hand, path in tracks.hands.items()},
        objects={i: path + rng.normal(0.0, objects_m, path.shape) for i, path in tracks.objects.items()},
    )


def lost(tracks: Tracks, rng: np.random.Generator, share: float, seconds: float = 0.4) -> Tracks:
    """Lose hands and objects for a while each, over about that share of the time."""
    return replace(
        tracks,
        hands={h: _known(path, ~_gone(tracks, share, seconds, rng)) for h, path in tracks.hands.items()},
        seen={i: seen & ~_gone(tracks, share, seconds, rng) for i, seen in tracks.seen.items()},
    )


def bounds_off(tracks: Tracks, rng: np.random.Generator, by_s: float) -> Tracks:
    """Mark starts and ends up to so much too early or too late."""
    return _bounds_moved(tracks, {name: rng.uniform(-by_s, by_s, 2) for name in tracks.bounds})


def bounds_as_found(tracks: Tracks, rng: np.random.Generator) -> Tracks:
    """Move starts and ends as those are off that the classifier finds in the simulated scene."""
    shares = {name: rng.uniform(size=2) for name in tracks.bounds}
    late_s = {
        name: np.array([np.interp(share, QUANTILES, late) for share, late in zip(of, FOUND_LATE_S, strict=True)])
        for name, of in shares.items()
    }
    return _bounds_moved(tracks, late_s)


def _bounds_moved(tracks: Tracks, late_s: Mapping[str, Array]) -> Tracks:
    """Move each segment's start and end (2,), but not out of the take, nor past each other."""
    off = {name: (late_s[name] * SECOND_NS).astype(int).tolist() for name in tracks.bounds}
    first, last = int(tracks.stamps_ns[0]), int(tracks.stamps_ns[-1])
    moved = {n: [min(max(b + o, first), last) for b, o in zip(tracks.bounds[n], off[n], strict=True)] for n in off}
    return replace(tracks, bounds={n: (s, e) if s < e else tracks.bounds[n] for n, (s, e) in moved.items()})


def higher(tracks: Tracks, _: np.random.Generator, by_m: float) -> Tracks:
    """Work higher above the things that stand: all that is lifted is lifted so much further, gradually."""
    floor = {i: np.nanquantile(path[:, 1], 0.9) for i, path in tracks.objects.items()}
    lifted = {i: np.clip((floor[i] - path[:, 1]) / LIFTED_M, 0.0, 1.0) for i, path in tracks.objects.items()}
    raised = {i: path - by_m * lifted[i][:, None] * DOWN for i, path in tracks.objects.items()}
    hands = {}
    for hand, path in tracks.hands.items():
        share = np.zeros(len(path))
        for i, of in tracks.objects.items():
            near = np.linalg.norm(of - path, axis=1) <= IN_HAND_M
            share = np.maximum(share, np.where(near, np.nan_to_num(lifted[i]), 0.0))
        hands[hand] = path - by_m * share[:, None] * DOWN
    return replace(tracks, hands=hands, objects=raised)


def livelier(tracks: Tracks, _: np.random.Generator, factor: float) -> Tracks:
    """Let a hand and what it has stray so many times as far from the middle of what they do in a segment."""
    hands = {hand: path.copy() for hand, path in tracks.hands.items()}
    objects = {i: path.copy() for i, path in tracks.objects.items()}
    for name, (start, end) in tracks.bounds.items():
        inside = (tracks.stamps_ns >= start) & (tracks.stamps_ns <= end)
        hand = tracks.hands[tracks.actors[name]]
        share = np.sin(np.linspace(0.0, np.pi, int(inside.sum())))[:, None]
        by_m = (factor - 1) * share * (hand[inside] - np.nanmedian(hand[inside], axis=0))
        hands[tracks.actors[name]][inside] += by_m
        for i, path in tracks.objects.items():
            near = np.linalg.norm(path[inside] - hand[inside], axis=1) <= IN_HAND_M
            if near.mean() > 0.5 and i != STANDING:
                objects[i][inside] += np.nan_to_num(by_m)
    return replace(tracks, hands=hands, objects=objects)


def skewed(tracks: Tracks, _: np.random.Generator, by_s: float) -> Tracks:
    """Let the hands lag behind the objects."""
    late = tracks.stamps_ns - by_s * SECOND_NS
    hands = {
        hand: np.stack([np.interp(late, tracks.stamps_ns, axis) for axis in path.T], axis=1)
        for hand, path in tracks.hands.items()
    }
    return replace(tracks, hands=hands)


def _known(path: Array, known: NDArray[np.bool_]) -> Array:
    return np.where(known[:, None], path, np.nan)


def _direction(rng: np.random.Generator) -> Array:
    direction = rng.normal(size=3)
    return np.asarray(direction / np.linalg.norm(direction))


def _gone(tracks: Tracks, share: float, seconds: float, rng: np.random.Generator) -> NDArray[np.bool_]:
    stamps_s = (tracks.stamps_ns - tracks.stamps_ns[0]) / SECOND_NS
    starts = rng.uniform(0.0, stamps_s[-1], rng.poisson(share * stamps_s[-1] / seconds))
    gone = np.zeros(len(stamps_s), dtype=bool)
    for start in starts:
        gone |= (stamps_s >= start) & (stamps_s < start + seconds)
    return gone


class Variation(NamedTuple):
    """A change by one of several amounts: those that the fusion was made with, and those looked at after."""

    what: str
    change: Change
    chosen_on: Mapping[str, tuple[float, ...]]
    looked_at: Mapping[str, tuple[float, ...]]


VARIATIONS = (
    Variation("mirrored", mirrored, {"left for right": ()}, {}),
    Variation("tempo", tempo, {"x 0.5": (0.5,), "x 1.5": (1.5,)}, {"x 0.7": (0.7,), "x 2": (2.0,)}),
    Variation("size", size, {"x 0.75": (0.75,), "x 1.25": (1.25,)}, {"x 0.85": (0.85,), "x 1.4": (1.4,)}),
    Variation("hands' markers elsewhere", hands_elsewhere, {"3 cm": (0.03,)}, {"5 cm": (0.05,)}),
    Variation("objects' middles elsewhere", objects_elsewhere, {"3 cm": (0.03,)}, {"5 cm": (0.05,)}),
    Variation("noise of hands and objects", noise, {"1, 0.3 cm": (0.01, 0.003)}, {"2, 0.5 cm": (0.02, 0.005)}),
    Variation("lost, 0.4 s at a time", lost, {"10 %": (0.1,)}, {"20 %": (0.2,)}),
    Variation("marks too early or late", bounds_off, {"0.2 s": (0.2,)}, {"0.3 s": (0.3,)}),
    Variation("worked higher", higher, {"4 cm": (0.04,)}, {"8 cm": (0.08,)}),
    Variation("livelier", livelier, {"x 1.5": (1.5,)}, {"x 2": (2.0,)}),
    Variation("hands late", skewed, {"50 ms": (0.05,)}, {"100 ms": (0.1,)}),
)
