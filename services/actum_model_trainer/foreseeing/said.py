"""What a network of contacts says in a take, as it does live."""

from typing import NamedTuple

import numpy as np

from action_fusion.intent.approach import FEATURES, approach
from action_fusion.intent.contact_network import ContactNetwork
from action_fusion.intent.intents import touched_soon
from action_fusion.intent.recent_beginnings import RecentBeginnings
from action_fusion.intent.recent_paths import RecentArms, RecentObjects
from actum.arrays import Array
from actum_model_trainer.foreseeing.scoring import HORIZON_S, Said
from actum_model_trainer.foreseeing.takes import Take


class Seen(NamedTuple):
    """What a network sees in a take.

    Attributes:
        features: (T, 2, objects, features) of every frame; NaN at the start.
        begun: (T,), how many objects have begun to move lately.
    """

    features: Array
    begun: Array


def said_by(network: ContactNetwork, take: Take) -> Said:
    """Return what a network says at each frame: each object's probability that it is touched within the horizon."""
    scores, times_s = [], []
    for features, begun in zip(*seen_in(take), strict=True):
        foreseen = network.foresee(features, begun)
        scores.append(touched_soon(foreseen.probability))
        nearer = foreseen.probability.argmax(axis=0)
        times_s.append(np.minimum(foreseen.contact_s[nearer, np.arange(len(nearer))], HORIZON_S))
    return Said(take, np.array(scores), np.array(times_s))


def seen_in(take: Take) -> Seen:
    """Return what is seen in every frame, as it is computed live."""
    arms, objects, beginnings = RecentArms(), RecentObjects(), RecentBeginnings()
    begun = np.zeros(len(take.stamps_ns))
    features = np.full((len(take.stamps_ns), 2, len(take.objects_m), FEATURES), np.nan)
    numbers = sorted(take.objects_m)
    for row, (stamp_ns, sighted) in enumerate(zip(take.stamps_ns.tolist(), take.sightings(), strict=True)):
        objects.append(sighted)
        arms.append(stamp_ns, take.arms_m[row])
        seen = approach(arms, objects, stamp_ns)
        features[row, :, [numbers.index(number) for number in seen.names]] = seen.features.swapaxes(0, 1)
        begun[row] = beginnings.with_moved(stamp_ns, seen.moved)
    return Seen(features, begun)
