"""What a model of one person says of other people, of actions it was not taught, and of other scenes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from sklearn.metrics import roc_auc_score

from actum.node import SECOND_NS
from actum_model_trainer.calibration_error import calibration_error, confidence_bins
from som_classifier.model import Recognition

from .bench import Bench
from .datasets import Datasets, Example
from .development import DevelopmentSet, development_sets, said_of_videos
from .ours import OURS
from .peers import MINIROCKET, MINIROCKET_UPRIGHT
from .scores import Floats, percent, table
from .splits import FEW_DRAWS, FEW_TESTED, SEED, FewExamples, few_examples
from .videos import PIECE_NS, why_no_camera

COUNTS = (5, 1)
LEFT_OUT_SHARE = 0.25
STRANGE_TESTED = 100
"""How many sequences of other sets a draw is asked about at most."""
STRANGE_SHARE = 0.25
"""How many actions left out, and as many of other sets, count in the calibration of familiarity for each that was
taught: so many training assumes."""

SURE, UNSURE = 0.8, 0.5
KNOWN, LEFT_OUT, ELSEWHERE = "taught", "left out", "other sets"
SCORES = ("our familiarity", "our confidence", "MiniRocket's margin", "the same, our upright postures")

ALIKE: tuple[frozenset[str], ...] = tuple(
    frozenset(names.split(", "))
    for names in (
        "high arm wave, horizontal arm wave, two hand wave, waveHands, wave, lift arms, push right",
        "hand clap, clapHands, clap",
        "bend, pickup & throw, pickUp, tight lace, bow, duck, sitDown, sit down, standUp, stand up",
        "high throw, forward punch, side boxing, hammer, hand catch, tennis serve, tennis swing, pickup & throw, "
        "throw, push, shoot, beat both",
        "forward kick, side kick, kick",
        "jogging, walk, carry",
        "drink, answer phone, goggles, had enough",
        "draw circle, wind up",
    )
)
"""Actions of several sets that may be the same movement: where one is taught, the others of its row are not strange."""


@dataclass
class Asked:
    """The answers of all draws at one number of examples."""

    areas: dict[str, list[list[float]]] = field(default_factory=lambda: {LEFT_OUT: [], ELSEWHERE: []})
    answers: dict[str, list[Recognition]] = field(default_factory=lambda: {KNOWN: [], LEFT_OUT: [], ELSEWHERE: []})
    right: list[bool] = field(default_factory=list)

    def add(self, training: Sequence[Example], groups: dict[str, list[Example]]) -> None:
        """Train on a draw's sequences, and ask about the three groups."""
        ours = OURS.fit(training)
        rockets = [rocket.fit(training) for rocket in (MINIROCKET, MINIROCKET_UPRIGHT)]
        scores = {}
        for name, asked in groups.items():
            answers = ours.recognitions(asked)
            self.answers[name] += answers
            margins = [_margins(rocket.decisions(asked)) for rocket in rockets]
            scores[name] = np.array([[a.familiarity for a in answers], [a.confidence for a in answers], *margins])
            if name == KNOWN:
                self.right += [a.label == example.label for a, example in zip(answers, asked, strict=True)]
        for unknown, areas in self.areas.items():
            areas.append([_area(own, other) for own, other in zip(scores[KNOWN], scores[unknown], strict=True)])

    def unknown(self, name: str) -> str:
        """Write how many of a group are told unknown."""
        return percent(float(np.mean([answer.unknown for answer in self.answers[name]])))

    @property
    def verified(self) -> tuple[list[float], list[bool]]:
        """List familiarities, and whether each is of a true instance of the action that is named."""
        known = [answer.familiarity or 0.0 for answer in self.answers[KNOWN]]
        strange = []
        for name in (LEFT_OUT, ELSEWHERE):
            step = max(len(self.answers[name]) / (STRANGE_SHARE * len(known)), 1.0)
            counted = [self.answers[name][int(n * step)] for n in range(int(len(self.answers[name]) / step))]
            strange += [answer.familiarity or 0.0 for answer in counted]
        return known + strange, self.right + [False] * len(strange)

    def sure(self, name: str) -> str:
        """Write how many are told with confidence."""
        return percent(float(np.mean([a.confidence > SURE and not a.unknown for a in self.answers[name]])))


def one_person(bench: Bench) -> Iterator[str]:
    """How honest a model of one person is."""
    sets = development_sets(bench.data)
    yield f"""One person taught (up to 5 examples of each action, or 1), about a quarter of the actions left out of
training, other people asked: {FEW_DRAWS} draws of person and actions, at most {FEW_TESTED} sequences of the set a draw.
"Other sets" are at most {STRANGE_TESTED} sequences a draw, as many of each, without those that may be the same movement
as one that was taught, as a table in the code says.{said_of_videos()} AUROC: how often an action that was
taught scores higher than one that was not (0.5 is chance); mean over the draws. Margin: largest minus second value of
the ridge."""
    measured = [(each.name, count, _asked(each, sets, count)) for each in sets for count in COUNTS]
    header = [f"{name}: {score}" for name in (LEFT_OUT, ELSEWHERE) for score in SCORES]
    yield table(("set, examples", *header), ([f"{name}, {count}", *_areas(own)] for name, count, own in measured))
    yield f"""At the threshold that our model sets by itself, all draws pooled: how many (%) are told unknown, and of
those not taught how many are told with a confidence above {SURE} and not unknown. Right, confidence (means) and ECE are
of the answers to actions that were taught. ECE of familiarity: whether a segment is a true instance of the action it is
called as often as its familiarity says; left out and other sets count {STRANGE_SHARE} each for each that was taught."""
    header = [
        "right %",
        "confidence %",
        "ECE",
        "ECE of familiarity",
        *(f"unknown: {name}" for name in (KNOWN, LEFT_OUT, ELSEWHERE)),
    ]
    header += [f"sure: {name}" for name in (LEFT_OUT, ELSEWHERE)]
    yield table(("set, examples", *header), ([f"{name}, {count}", *_told(own)] for name, count, own in measured))
    if why_no_camera() is None:
        yield from _exercises(bench.data)


def _asked(own: DevelopmentSet, sets: Sequence[DevelopmentSet], count: int) -> Asked:
    of_actions, of_strangers, asked = np.random.default_rng(SEED), np.random.default_rng(SEED), Asked()
    labels = sorted({example.label for example in own.examples})
    others = [other for other in sets if other is not own]
    for draw in few_examples(own.examples, own.of_few):
        chosen = of_actions.choice(len(labels), round(LEFT_OUT_SHARE * len(labels)), replace=False).tolist()
        left_out = {labels[i] for i in chosen}
        taught = [example for example in draw.training(1, count) if example.label not in left_out]
        asked.add(taught, _groups(draw, left_out, _strange(others, set(labels) - left_out, of_strangers)))
    return asked


def _groups(draw: FewExamples, left_out: set[str], strange: list[Example]) -> dict[str, list[Example]]:
    known = [example for example in draw.test if example.label not in left_out]
    return {KNOWN: known, LEFT_OUT: [e for e in draw.test if e.label in left_out], ELSEWHERE: strange}


def _strange(others: Sequence[DevelopmentSet], taught: set[str], rng: np.random.Generator) -> list[Example]:
    """Draw from each of the other sets sequences whose action is not like one that was taught."""
    like = taught.union(*(names for names in ALIKE if names & taught))
    strange = []
    for other in others:
        unlike = [example for example in other.examples if example.label not in like]
        drawn = rng.permutation(len(unlike))[: STRANGE_TESTED // len(others)]
        strange += [unlike[i] for i in sorted(drawn.tolist())]
    return strange


def _margins(decisions: Floats) -> Floats:
    ordered = np.sort(decisions, axis=1)
    margins: Floats = ordered[:, -1] - ordered[:, -2]
    return margins


def _area(known: Floats, unknown: Floats) -> float:
    is_known = [True] * len(known) + [False] * len(unknown)
    return float(roc_auc_score(is_known, np.concatenate([known, unknown])))


def _areas(own: Asked) -> list[str]:
    means = np.concatenate([np.mean(own.areas[name], axis=0) for name in (LEFT_OUT, ELSEWHERE)])
    return [f"{mean:.3f}" for mean in means]


def _told(own: Asked) -> list[str]:
    confidences, right = np.array([answer.confidence for answer in own.answers[KNOWN]]), np.array(own.right)
    errors = [f"{calibration_error(confidence_bins(*each)):.3f}" for each in ((confidences, right), own.verified)]
    unknown = [own.unknown(name) for name in (KNOWN, LEFT_OUT, ELSEWHERE)]
    sure = [own.sure(name) for name in (LEFT_OUT, ELSEWHERE)]
    return [percent(right.mean()), percent(confidences.mean()), *errors, *unknown, *sure]


def _exercises(data: Datasets) -> Iterator[str]:
    """Ask models of one person of the videos about gymnasts."""
    yield f"""A video of three gymnasts, of whom one is followed, seen as the clips of Florence are and cut into pieces
of {PIECE_NS / SECOND_NS:.0f} s: {len(data.exercise)} in which anybody was seen. Models of one person of Florence, all
their clips taught; none of those actions is done in the video, where arms and legs are swung and people step to the
side. Share of the pieces (%)."""
    header = ("person taught", "told unknown", f"or below {UNSURE}", f"above {SURE} and not unknown")
    yield table(header, (_exercise_row(data, person) for person in sorted({e.person for e in data.florence})))


def _exercise_row(data: Datasets, person: int) -> list[str]:
    given = [example for example in data.florence if example.person == person]
    answers = OURS.fit(given).recognitions(data.exercise)
    shares = (
        [answer.unknown for answer in answers],
        [answer.unknown or answer.confidence < UNSURE for answer in answers],
        [answer.confidence > SURE and not answer.unknown for answer in answers],
    )
    return [str(person), *(percent(float(np.mean(share))) for share in shares)]
