"""Whether people who stand still, marked as if they acted, are taken to do one of the actions."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from actum.node import SECOND_NS
from actum.recorder import write_recording
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.confidence import LEAST_MOVEMENT_SHARE, least_movement_m
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import LabelledStream, SegmentSample
from scene_simulator.driven_simulator import DrivenSimulator
from scene_simulator.settings import Settings
from som_classifier.kinematics import averaged, movement_m
from som_classifier.model import Model, Recognition
from som_classifier.pyramid_model import PyramidModel

from .bench import Bench
from .datasets import Datasets, joints_by_stamp
from .development import DevelopmentSet, development_sets, said_of_videos
from .one_person import SURE
from .ours import OURS
from .scores import Floats, percent, table
from .splits import FEW_DRAWS, SEED, few_examples

PIECE_NS = 3 * SECOND_NS // 2
"""How long the pieces are that recordings are cut into: some pauses between two actions are no longer."""
APART_NS = SECOND_NS // 5
"""How far pieces keep from labelled segments, in whose bounds people may move already."""
AVERAGED_NS = 2 * SECOND_NS // 5
FEWEST_FRAMES, LONGEST_GAP_NS = 8, 3 * SECOND_NS // 10
WITHIN_M = 0.06
"""Nobody moves where 95 % of the hands', elbows', knees' and feet's means are this near to their median."""
LIMBS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("hand", "elbow", "knee", "foot")]
STANDING_PEOPLE, STANDING_S, RATE_HZ = range(100, 108), 18, 30
WAYS = ("1 × 1", "1 × 5", "all others")
SHARES = (0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)
LIMITS = (0.005, 0.01)
"""Shares of the actions that may count as still."""
ASKED = 25
"""Pieces of each source, and four times as many actions, that a trained model is asked about."""

Pieces = Mapping[str, Sequence[SegmentSample]]


@dataclass(frozen=True)
class Ratios:
    """Movements, as multiples of that of the taught action that moves least: of actions, and of standing people."""

    name: str
    way: str
    acting: Floats
    standing: Mapping[str, Floats]

    def lost(self, share: float) -> float:
        """Return how many of the actions would count as still."""
        return float((self.acting < share).mean())

    def row(self, share: float) -> list[str]:
        caught = (percent(float((ratios < share).mean())) for ratios in self.standing.values())
        return [percent(self.lost(share)), *caught]


def stillness(bench: Bench) -> Iterator[str]:
    """What counts as still, and what models of one example of each action answer."""
    sets, pieces = development_sets(bench.data), standing(bench.data)
    found = ", ".join(f"{len(own)} of {name}" for name, own in pieces.items())
    yield f"""A segment that moves less than a share of the usual movement of the taught action that moves least counts
as still, and is answered `unknown`. Standing: pieces of {PIECE_NS / SECOND_NS} s between actions in which hands,
elbows, knees and feet stay within {100 * WITHIN_M:.0f} cm ({found}).{said_of_videos()} Taught by one person (1 or 5
examples of each action, {FEW_DRAWS} draws) or by all others; actions are of people who did not teach. Share (%) that
counts as still at {LEAST_MOVEMENT_SHARE}, the value in use:"""
    measured = [ratios for each in sets for ratios in ratios_of(each, pieces)]
    rows = ([each.name, each.way, *each.row(LEAST_MOVEMENT_SHARE)] for each in measured)
    yield table(("set", "taught", "actions", *(f"standing: {name}" for name in pieces)), rows)
    yield f"""Each set left out in turn: the largest of {", ".join(map(str, SHARES))} at which no more of the actions of
every other set count as still than a limit, and what it gives on the set left out (the worst of its rows)."""
    yield table(("left out", "limit", "share", "actions, at most", "standing, at least"), _left_out(measured, sets))
    yield f"""Models of one person and one example of each action, {FEW_DRAWS} draws, without and with that: how many
answers (%) are `unknown`, and how many are given with a confidence above {SURE} and not `unknown`."""
    header = ("set", "actions: unknown", "standing: unknown", "standing: sure")
    yield table(header, (_answered(each, pieces) for each in sets))


def standing(data: Datasets) -> dict[str, list[SegmentSample]]:
    """Cut the pieces in which people stand out of UTKinect, MSRC-12 and the simulated scene."""
    with TemporaryDirectory() as folder:
        simulated = [_recorded(Path(folder) / f"{actor}.mcap", actor) for actor in STANDING_PEOPLE]
        sources = {"UTKinect": data.utkinect_recordings, "MSRC-12": data.msrc12_trimmed, "simulated": simulated}
        return {name: [piece for each in own for piece in _pieces(each)] for name, own in sources.items()}


def _recorded(path: Path, actor: int) -> Recording:
    frames = islice(DrivenSimulator(Settings(actor=actor, image_hz=0), 0).frames(), STANDING_S * RATE_HZ)
    messages = (message for of_frame in frames for message in of_frame)
    write_recording(path, messages, person=str(actor), source="simulator")
    return Recording(path)


def _pieces(recording: Recording) -> Iterator[SegmentSample]:
    joints_m = joints_by_stamp(recording)
    for stream in samples_from([recording]).streams:
        numbers = (stream.stamps_ns - stream.stamps_ns[0]) // PIECE_NS
        for number in np.unique(numbers)[:-1].tolist():
            piece = _part(stream, np.flatnonzero(numbers == number))
            if _is_idle(stream, piece) and _stands(piece, joints_m):
                yield piece


def _part(stream: LabelledStream, frames: Floats) -> SegmentSample:
    parts = stream.stamps_ns[frames], stream.postures[frames], stream.motion[frames], stream.postures[frames]
    return SegmentSample("", *parts, stream.velocities[frames], stream.person, stream.file, "")


def _is_idle(stream: LabelledStream, piece: SegmentSample) -> bool:
    """Tell whether a piece is whole and lies apart from labelled segments."""
    stamps_ns = piece.stamps_ns
    whole = len(stamps_ns) >= FEWEST_FRAMES and np.diff(stamps_ns).max() <= LONGEST_GAP_NS
    spans = ((start - APART_NS, end + APART_NS) for start, end, _ in stream.segments)
    return bool(whole) and not any(start <= stamps_ns[-1] and stamps_ns[0] <= end for start, end in spans)


def _stands(piece: SegmentSample, joints_m: Mapping[int, Floats]) -> bool:
    """Tell whether nobody moves, by the joints as they were measured."""
    measured = np.stack([joints_m[int(stamp_ns)] for stamp_ns in piece.stamps_ns])
    limbs = measured[:, LIMBS] - measured[:, [INDEX["torso"]]]
    numbers = (piece.stamps_ns - piece.stamps_ns[0]) // AVERAGED_NS
    means = np.stack([limbs[numbers == number].mean(axis=0) for number in np.unique(numbers)])
    away_m = np.linalg.norm(means - np.median(means, axis=0), axis=2)
    return bool(np.quantile(away_m, 0.95) <= WITHIN_M)


def ratios_of(each: DevelopmentSet, pieces: Pieces) -> Iterator[Ratios]:
    """Measure one set, taught in each of the `WAYS`."""
    draws = list(few_examples(each.examples, each.of_few))
    taught = [[(draw.training(1, count), draw.test) for draw in draws] for count in (1, 5)]
    for way, splits in zip(WAYS, [*taught, [(own.training, own.test) for own in each.splits]], strict=True):
        usual_m = [_usual_m([e.sample for e in own]) for own, _ in splits]
        acting = [_moved([e.sample for e in test]) / of for of, (_, test) in zip(usual_m, splits, strict=True)]
        still = {name: np.divide.outer(_moved(own), usual_m).ravel() for name, own in pieces.items()}
        yield Ratios(each.name, way, np.concatenate(acting), still)


def _usual_m(samples: Sequence[SegmentSample]) -> float:
    labels = np.unique([sample.label for sample in samples], return_inverse=True)[1]
    return least_movement_m(_moved(samples), labels) / LEAST_MOVEMENT_SHARE


def _moved(samples: Sequence[SegmentSample]) -> Floats:
    return np.array([movement_m(averaged(sample.stamps_ns, sample.postures)) for sample in samples])


def _left_out(measured: Sequence[Ratios], sets: Sequence[DevelopmentSet]) -> Iterator[list[str]]:
    for left_out, limit in product(sets, LIMITS):
        others = [each for each in measured if each.name != left_out.name]
        share = max(share for share in SHARES if all(each.lost(share) <= limit for each in others))
        own = [each for each in measured if each.name == left_out.name]
        caught = min(float((ratios < share).mean()) for each in own for ratios in each.standing.values())
        lost = percent(max(each.lost(share) for each in own))
        yield [left_out.name, f"{limit:.1%}", str(share), lost, percent(caught)]


def _answered(each: DevelopmentSet, pieces: Pieces) -> list[str]:
    """Ask models of one person and one example about actions and about standing people."""
    rng, acting, still = np.random.default_rng(SEED), [], []
    for draw in few_examples(each.examples, each.of_few):
        model = OURS.fit(draw.training(1, 1)).model
        asked = [own[i] for own in pieces.values() for i in rng.permutation(len(own))[:ASKED].tolist()]
        tested = [draw.test[i].sample for i in rng.permutation(len(draw.test))[: 4 * ASKED].tolist()]
        acting += _answers(model, tested)
        still += _answers(model, asked)
    return [each.name, _change(acting, _is_unknown), _change(still, _is_unknown), _change(still, _is_sure)]


def _answers(model: Model, asked: Sequence[SegmentSample]) -> list[tuple[Recognition, Recognition]]:
    """Return each answer of a model that measures no movement, and of the model itself."""
    assert isinstance(model, PyramidModel)
    without = replace(model, body=replace(model.body, least_m=0.0))
    frames = [encoded(model, sample) for sample in asked]
    return [(answer(without, own), answer(model, own)) for own in frames]


def _change(answers: Sequence[tuple[Recognition, Recognition]], holds: Callable[[Recognition], bool]) -> str:
    before, after = (float(np.mean([holds(answer) for answer in own])) for own in zip(*answers, strict=True))
    return f"{percent(before)} → {percent(after)}"


def _is_unknown(answer: Recognition) -> bool:
    return answer.unknown


def _is_sure(answer: Recognition) -> bool:
    return answer.confidence > SURE and not answer.unknown
