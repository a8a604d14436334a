"""Learns the network of contacts that comes with actum, from simulated people and motion capture.

python -m benchmarks.intent.learning [DIR]

DIR is the folder of the OptiTrack takes; without it the network learns from simulated people alone.
"""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple, Self

import numpy as np
from benchmarks.intent.balancing import balance, softmax
from benchmarks.intent.takes import bare, captured, everyday, simulated, without_body

import action_fusion.intent
from action_fusion.intent.approach import FEATURES
from action_fusion.intent.contact_network import SHIPPED, WIDEST, ContactNetwork
from actum.arrays import Array
from actum.node import SECOND_NS
from actum_model_trainer.foreseeing.said import seen_in
from actum_model_trainer.foreseeing.scoring import HORIZON_S
from actum_model_trainer.foreseeing.takes import Take

PERSONS, SEED = range(1, 25), 3
"""The simulated people learnt from; others are tested."""
EVERYDAY_PERSONS, EVERYDAY_MIN = range(30, 90), 2.0
"""Those who do everyday things, and for how long each (minutes)."""
EVERYDAY_WEIGHT = 2.0
"""Weight of an instant of theirs: more, and contacts are announced later; less, and more often in vain. Chosen, as the
size of the networks, on people 91 to 99."""
NETWORKS, HIDDEN, STEPS, BATCH = 3, 24, 4000, 2048
"""Networks that are averaged, units in each layer, steps of Adam, and instants in each."""
RATE, WARM_UP, DECAY = 4e-3, 100, 1e-5
"""Adam's rate, the steps in which it rises, and the decay of the weights."""
CAPTURED_WEIGHT = 20.0
"""Weight of an instant of motion capture beside a simulated one: there are a hundred times fewer."""
USUAL_SHARE = 0.25
"""Share of that weight where it is learnt how often people act: motion capture begins and ends with actions."""
STRIDE = 2
"""Of the instants before no contact, one of so many is learnt from, with that weight."""
MOST_OBJECTS = 5
"""Objects in a take."""


class Examples(NamedTuple):
    """Instants (N,) of hands: features (N, objects, features), which objects there are, which is touched next if any,
    their weights, the time until the touch (s), and how many objects have begun to move lately."""

    features: Array
    present: Array
    touched: Array
    weights: Array
    ahead_s: Array
    begun: Array

    @classmethod
    def of(cls, takes: Iterable[Take], weight: float = 1.0) -> Self:
        """Return the instants of takes, all of the same weight."""
        return cls(*map(np.concatenate, zip(*(_of_take(take, weight) for take in takes), strict=True)))

    @classmethod
    def joined(cls, several: Iterable["Examples"]) -> Self:
        """Return all instants of several."""
        return cls(*map(np.concatenate, zip(*several, strict=True)))


def _of_take(take: Take, weight: float) -> tuple[Array, ...]:
    features, begun = seen_in(take)
    frames, hands, objects = features.shape[:3]
    next_s, touched = np.full((frames, hands), np.inf), np.zeros((frames, hands, MOST_OBJECTS), np.float32)
    numbers = sorted(take.objects_m)
    for contact in reversed(take.contacts):
        ahead_s = (contact.stamp_ns - take.stamps_ns) / SECOND_NS
        before = (ahead_s > 0) & (ahead_s <= HORIZON_S)
        touched[before, contact.hand] = np.arange(MOST_OBJECTS) == numbers.index(contact.number)
        next_s[before, contact.hand] = ahead_s[before]
    padded = np.zeros((frames, hands, MOST_OBJECTS, FEATURES), np.float32)
    padded[:, :, :objects] = np.nan_to_num(features)
    near = touched.any(axis=2)
    kept = np.isfinite(features).all(axis=(2, 3)) & (near | (np.arange(frames) % STRIDE == 0)[:, None])
    present = np.broadcast_to(np.arange(MOST_OBJECTS) < objects, touched.shape)
    weights = weight * np.where(near, 1.0, STRIDE)
    each_begun = np.broadcast_to(begun[:, None], near.shape)
    return padded[kept], present[kept], touched[kept], weights[kept], next_s[kept], each_begun[kept]


def learnt(
    simulated: Examples, real: Sequence[Examples], networks: int = NETWORKS, steps: int = STEPS
) -> ContactNetwork:
    """Learn the networks, each from another beginning, and the time to contact."""
    examples = Examples.joined([simulated, *real])
    there = examples.features[examples.present]
    mean, sd = there.mean(axis=0, dtype=np.float64), there.std(axis=0, dtype=np.float64) + 1e-6
    unit = np.clip((examples.features - mean) / sd, -WIDEST, WIDEST).astype(np.float32)
    usual = Examples.joined([simulated, *(each._replace(weights=USUAL_SHARE * each.weights) for each in real)])
    weights = [_balanced(_network(unit, examples, steps, seed), unit, usual) for seed in range(networks)]
    names = ("into", "into_bias", "between", "between_bias", "out", "out_bias", "lively", "among")
    layers = {name: np.array([each[k] for each in weights]) for k, name in enumerate(names)}
    return ContactNetwork.of({"mean": mean, "sd": sd, **layers, **_time_to_contact(unit, examples)})


def _network(unit: Array, examples: Examples, steps: int, seed: int) -> list[Array]:
    """Learn one network by Adam: cross entropy of which object is touched next, if any."""
    rng = np.random.default_rng(seed)
    shapes = ((FEATURES, HIDDEN), (HIDDEN,), (HIDDEN, HIDDEN), (HIDDEN,), (HIDDEN,), ())
    weights = [rng.normal(0, shape[0] ** -0.5, shape) if len(shape) == 2 else np.zeros(shape) for shape in shapes]
    weights[4] = rng.normal(0, HIDDEN**-0.5, HIDDEN)
    weights = [np.asarray(each, np.float32) for each in weights]
    means, squares = ([np.zeros_like(each) for each in weights] for _ in range(2))
    worth = examples.weights / examples.weights.mean()
    for step in range(1, steps + 1):
        drawn = rng.integers(0, len(unit), BATCH)
        of_drawn = unit[drawn], examples.present[drawn], examples.touched[drawn], worth[drawn]
        rate = RATE * min(1.0, step / WARM_UP) * (1 - step / steps) + 1e-5
        for k, of_loss in enumerate(_slopes(weights, *of_drawn)):
            slope = of_loss + DECAY * weights[k] * (k in (0, 2, 4))
            means[k] = 0.9 * means[k] + 0.1 * slope
            squares[k] = 0.999 * squares[k] + 0.001 * slope**2
            moved = means[k] / (1 - 0.9**step) / (np.sqrt(squares[k] / (1 - 0.999**step)) + 1e-8)
            weights[k] = np.asarray(weights[k] - rate * moved, np.float32)
    return weights


def _slopes(weights: list[Array], unit: Array, present: Array, touched: Array, worth: Array) -> list[Array]:
    """Return the gradient of the mean loss with respect to each array of weights."""
    into, into_bias, between, between_bias, out, out_bias = weights
    rows = unit.reshape(-1, FEATURES)
    first = np.tanh(rows @ into + into_bias)
    second = np.tanh(first @ between + between_bias)
    probability = softmax(np.where(present, (second @ out + out_bias).reshape(present.shape), -np.inf))
    wrong = ((probability - touched) * (worth / len(unit))[:, None]).astype(np.float32).ravel()
    by_second = np.outer(wrong, out) * (1 - second**2)
    by_first = by_second @ between.T * (1 - first**2)
    return [rows.T @ by_first, by_first.sum(0), first.T @ by_second, by_second.sum(0), second.T @ wrong, wrong.sum()]


def _balanced(weights: list[Array], unit: Array, examples: Examples) -> list[Array]:
    """Return the weights of a network whose scores are balanced, and what the objects and their motion add to them."""
    into, into_bias, between, between_bias, out, out_bias = weights
    hidden = (np.tanh(np.tanh(part @ into + into_bias) @ between + between_bias) for part in np.array_split(unit, 100))
    scores = np.where(examples.present, np.concatenate([part @ out + out_bias for part in hidden]), -np.inf)
    found = balance(scores, examples.touched, examples.weights, examples.begun)
    balanced = [found.scale * out, found.scale * out_bias + found.offset]
    return [into, into_bias, between, between_bias, *balanced, np.array(found.lively), np.array(found.among)]


def _time_to_contact(unit: Array, examples: Examples) -> dict[str, Array]:
    """Regress the logarithm of the time until the next contact on the features of its object."""
    soon = examples.touched.any(axis=1)
    inputs = np.pad(unit[soon][examples.touched[soon] > 0], ((0, 0), (0, 1)), constant_values=1.0).astype(np.float64)
    logs, worth = np.log(np.maximum(examples.ahead_s[soon], 0.02)), examples.weights[soon][:, None]
    time = np.linalg.solve(inputs.T @ (inputs * worth) + np.eye(inputs.shape[1]), inputs.T @ (logs * worth[:, 0]))
    return {"time": time, "time_sd": np.array(np.std(logs - inputs @ time))}


def acting_takes() -> list[Take]:
    """Return the simulated takes with actions: seen by a depth camera, and as motion capture has them."""
    seen = simulated(PERSONS, SEED)
    varied = [without_body(take) if number % 3 == 0 else take for number, take in enumerate(seen)]
    return [*varied, *bare(PERSONS, SEED)]


def background_takes() -> list[Take]:
    """Return the everyday takes that are learnt from."""
    return everyday(EVERYDAY_PERSONS, SEED, EVERYDAY_MIN)


def main() -> None:
    """Learn from all that there is, and write the network beside the code that uses it."""
    real = captured(Path(sys.argv[1])) if len(sys.argv) > 1 else []
    usual = Examples.joined([Examples.of(acting_takes()), Examples.of(background_takes(), EVERYDAY_WEIGHT)])
    network = learnt(usual, [Examples.of([take], CAPTURED_WEIGHT) for take in real])
    path = Path(action_fusion.intent.__file__).with_name(SHIPPED)
    arrays = {name: getattr(network, name).astype(np.float32) for name in ContactNetwork.__dataclass_fields__}
    np.savez(path, **arrays)
    print(f"{path.name}: {path.stat().st_size} bytes, learnt from simulated people and {len(real)} captured takes")


if __name__ == "__main__":
    main()
