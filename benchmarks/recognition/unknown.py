"""Whether actions that were never trained are told from those that were."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from sklearn.metrics import roc_auc_score

from som_classifier.model import Recognition

from .bench import Bench
from .datasets import Example
from .ours import OURS
from .peers import MINIROCKET
from .scores import Difference, Floats, Score, table
from .splits import DRAWS, LEFT_OUT, actions_left_out, odd_even

FAMILIARITY, CONFIDENCE = "actum, familiarity", "actum, confidence"
MARGIN, LARGEST = "MiniRocket + ridge, largest minus second", "MiniRocket + ridge, largest"


@dataclass
class Outcomes:
    """What the draws gave: areas under the curve by score, and flags at our own threshold."""

    unknown: list[list[str]] = field(default_factory=list)
    areas: dict[str, list[float]] = field(default_factory=dict)
    flagged: Score = field(default_factory=lambda: Score(0, 0))
    caught: Score = field(default_factory=lambda: Score(0, 0))

    def add(self, unknown: list[str], known: Sequence[bool], answers: Sequence[Recognition], decisions: Floats) -> None:
        """Count one draw."""
        self.unknown.append(unknown)
        for name, scores in _scores(answers, decisions).items():
            self.areas.setdefault(name, []).append(float(roc_auc_score(known, scores)))
        flags = [answer.unknown for answer in answers]
        known_flags = [flag for flag, is_known in zip(flags, known, strict=True) if is_known]
        self.flagged += Score(sum(known_flags), len(known_flags))
        self.caught += Score(sum(flags) - sum(known_flags), len(flags) - len(known_flags))


def unknown_actions(bench: Bench) -> Iterator[str]:
    """Three actions left out of training, again and again."""
    drawn = Outcomes()
    for unknown, split in actions_left_out(odd_even(bench.data.msr)):
        answers = bench.fitted(OURS, split.training).recognitions(split.test)
        decisions = bench.fitted(MINIROCKET, split.training).decisions(split.test)
        drawn.add(unknown, _known(split.test, unknown), answers, decisions)
    yield f"""MSR Action3D, odd people trained, even people tested; {LEFT_OUT} of the 20 actions, drawn {DRAWS} times,
are left out of training and tested with the others. AUROC: how often a trained action scores higher than one left out
(0.5 is chance). Differences are paired by draw, ± standard error."""
    yield table(("score", "AUROC, mean", "s.d.", "minus MiniRocket's margin"), _area_rows(drawn))
    yield f"""At the threshold that our model sets by itself, over all draws: of the answers to trained actions
{_of(drawn.flagged)} are wrongly flagged `unknown`, of those to actions left out {_of(drawn.caught)} are caught."""
    rows = (
        [", ".join(names), *(f"{own[i]:.3f}" for own in drawn.areas.values())] for i, names in enumerate(drawn.unknown)
    )
    yield table(("left out", *drawn.areas), rows)


def _known(examples: Sequence[Example], unknown: Sequence[str]) -> list[bool]:
    return [example.label not in unknown for example in examples]


def _scores(answers: Sequence[Recognition], decisions: Floats) -> dict[str, Floats]:
    ordered = np.sort(decisions, axis=1)
    return {
        FAMILIARITY: np.array([answer.familiarity for answer in answers]),
        CONFIDENCE: np.array([answer.confidence for answer in answers]),
        MARGIN: ordered[:, -1] - ordered[:, -2],
        LARGEST: ordered[:, -1],
    }


def _area_rows(drawn: Outcomes) -> Iterator[list[str]]:
    margins = np.array(drawn.areas[MARGIN])
    for name, areas in drawn.areas.items():
        gap = Difference(np.array(areas) - margins)
        beside = "" if name == MARGIN else f"{gap.mean:+.3f} ± {gap.standard_error:.3f}"
        yield [name, f"{np.mean(areas):.3f}", f"{np.std(areas, ddof=1):.3f}", beside]


def _of(score: Score) -> str:
    return f"{score.correct} of {score.n} ({score.share:.1%})"
