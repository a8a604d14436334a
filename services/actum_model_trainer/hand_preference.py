"""Whether people prefer one hand: only then is an action of the left arm a left-hander's mirror image of the action."""

from collections import Counter
from collections.abc import Sequence

from actum.messages import Hand
from actum_model_trainer.samples import SegmentSample

MAX_OTHER_HAND_SHARE = 0.1  # of all one-armed samples: now and then even a right-hander uses the left


def people_prefer_one_hand(samples: Sequence[SegmentSample]) -> bool:
    """Return whether hardly any one-armed sample is done with the hand that its person uses less often.

    Where people change hands from action to action (reading the watch on the left arm, waving with the right), the
    hand itself distinguishes actions.
    """
    by_person: dict[str, Counter[Hand]] = {}
    for sample in samples:
        if (hand := sample.acting_hands[-1]) is not None:
            by_person.setdefault(sample.person, Counter())[hand] += 1
    with_other_hand = sum(min(counts["left"], counts["right"]) for counts in by_person.values())
    return with_other_hand <= MAX_OTHER_HAND_SHARE * sum(counts.total() for counts in by_person.values())
