"""Whether people keep to one hand: only then is an action of the left arm the same action, done by a left-hander."""

from collections import Counter
from collections.abc import Sequence

from actum.messages import Hand
from actum_model_trainer.samples import SegmentSample

MOST_OF_THE_OTHER = 0.1


def keep_to_one_hand(samples: Sequence[SegmentSample]) -> bool:
    """Tell whether hardly any one-armed sample is done with the hand that its person uses less.

    Where people change hands from action to action, as who reads the watch on the left arm and waves with the right,
    the hand tells actions apart.
    """
    by_person: dict[str, Counter[Hand]] = {}
    for sample in samples:
        if (hand := sample.acting_hands[-1]) is not None:
            by_person.setdefault(sample.person, Counter())[hand] += 1
    others = sum(min(counts["left"], counts["right"]) for counts in by_person.values())
    return others <= MOST_OF_THE_OTHER * sum(counts.total() for counts in by_person.values())
