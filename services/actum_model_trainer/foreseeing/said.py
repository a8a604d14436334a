"""What a network of contacts says in a take, as it does live."""

import numpy as np

from action_fusion.intent.approach import FEATURES, approach
from action_fusion.intent.contact_network import ContactNetwork
from action_fusion.intent.intents import touched_soon
from action_fusion.intent.recent_paths import RecentArms, RecentObjects
from actum.arrays import Array
from actum_model_trainer.foreseeing.scoring import HORIZON_S, Said
from actum_model_trainer.foreseeing.takes import Take


def said_by(network: ContactNetwork, take: Take) -> Said:
    """Return what a network says at each frame: each object's probability that it is touched within the horizon."""
    scores, times_s = [], []
    for features in features_of(take):
        foreseen = network.foresee(features)
        scores.append(touched_soon(foreseen.probability))
        nearer = foreseen.probability.argmax(axis=0)
        times_s.append(np.minimum(foreseen.contact_s[nearer, np.arange(len(nearer))], HORIZON_S))
    return Said(take, np.array(scores), np.array(times_s))


def features_of(take: Take) -> Array:
    """Return the features of every frame, (T, 2, objects, features), as they are computed live; NaN at the start."""
    arms, objects = RecentArms(), RecentObjects()
    features = np.full((len(take.stamps_ns), 2, len(take.objects_m), FEATURES), np.nan)
    numbers = sorted(take.objects_m)
    for row, (stamp_ns, sighted) in enumerate(zip(take.stamps_ns.tolist(), take.sightings(), strict=True)):
        objects.append(sighted)
        arms.append(stamp_ns, take.arms_m[row])
        seen = approach(arms, objects, stamp_ns)
        features[row, :, [numbers.index(number) for number in seen.names]] = seen.features.swapaxes(0, 1)
    return features
