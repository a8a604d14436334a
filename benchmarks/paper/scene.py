"""Table 2 of the paper on the simulated scene: one actor as there, and nine others."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchmarks.recognition.scores import table
from benchmarks.rig.chain import Chain

from action_fusion.settings import Settings as FusionSettings
from actum.messages import Event, Truth
from actum_command.demo.marked import TABLE_2
from actum_command.scene_marks import mark_of
from actum_model_trainer.training import train
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator
from som_classifier.model import Model
from som_classifier.presets import DEFAULT, Preset

from .data import TEST_SEED, TESTED_EACH, TRAINED_EACH, TRAINING_SEED, Data
from .measuring import BODY, PART, Shares, labels

TAIL_S = 1.0
IMAGE_HZ = 15
OTHERS = 9
ACTORS = 10
"""How many learn and are tested each alone."""
PAPERS_MEASURE = FusionSettings(measure="proximity")


@dataclass(frozen=True)
class Told:
    """One sample of the scene, and what was said of it."""

    truth: Truth
    event: Event | None

    @property
    def action_right(self) -> bool:
        return self.event is not None and self.event.action == self.truth.action

    @property
    def object_right(self) -> bool:
        return self.event is not None and self.event.object is not None and self.event.object.id == self.truth.object_id


def scene(data: Data) -> Iterator[str]:
    """The paper's experiment."""
    yield f"""Five actions, {TRAINED_EACH} samples of each to learn from and {TESTED_EACH} to test, three marked objects
as in the paper; a simulated actor instead of a person, drawn images, a Kinect's noise. The nodes that run live answer,
one after the other without transport; the object is the paper's nearest one. Right of {TESTED_EACH} in a row: action,
object."""
    one, others = [0], list(range(1, 1 + OTHERS))
    columns = {
        "`paper`, the same actor": played(_model(data, PART), one, TESTED_EACH),
        "`paper`, nine others": played(_model(data, PART), others, 1),
        f"`{DEFAULT.name}`, nine others": played(_model(data, DEFAULT), others, 1),
    }
    yield table(("action", "paper: a person", *columns), _rows(columns))
    yield f"""How much that depends on the actor: each of {ACTORS} alone, {TRAINED_EACH} samples of each action to learn
from and {TESTED_EACH} to test; right actions in %, mean ± standard deviation over actors."""
    presets: dict[str, Preset] = {
        "`paper`, the part that moves most": PART, "`paper`, the whole body": BODY, f"`{DEFAULT.name}`": DEFAULT
    }  # fmt: skip
    yield table(("recogniser", "one actor"), ([name, str(alone(data, preset))] for name, preset in presets.items()))


def alone(data: Data, preset: Preset) -> Shares:
    """Train and test actor after actor."""
    shares = []
    for actor in range(ACTORS):
        training, test = data.one_actor(actor)
        answers = labels(preset, training, test, 0)
        shares.append(sum(a == s.label for a, s in zip(answers, test, strict=True)) / len(test))
    return Shares(shares)


def played(model: Model, actors: Sequence[int], repetitions: int) -> list[Told]:
    """Let actors act before the nodes."""
    return [told for actor in actors for told in _of_one(model, actor, repetitions)]


def _of_one(model: Model, actor: int, repetitions: int) -> list[Told]:
    programme = balanced_programme(repetitions, TEST_SEED, actor)
    simulator = Simulator(programme, actor, TEST_SEED, image_hz=IMAGE_HZ, tail_s=TAIL_S)
    chain, truths, events = Chain(model, PAPERS_MEASURE), [], {}
    for message in (message for instant in simulator.frames() for message in instant):
        if isinstance(message, Truth) and message.kind == "end":
            truths.append(message)
        for said in chain.feed(mark_of(message) if isinstance(message, Truth) else message):
            if isinstance(said, Event):
                events[said.segment_id] = said
    return [Told(truth, events.get(truth.segment_id)) for truth in truths]


def _model(data: Data, preset: Preset) -> Model:
    return train(data.simulated(0, TRAINED_EACH, TRAINING_SEED), preset, 0)


def _rows(columns: dict[str, list[Told]]) -> Iterator[list[str]]:
    for action, (_, recognised, found) in TABLE_2.items():
        yield [action, f"{recognised}, {found}", *(_counts(told, action) for told in columns.values())]
    totals = [sum(counts[i] for counts in TABLE_2.values()) for i in (1, 2)]
    yield ["total", f"{totals[0]}, {totals[1]}", *(_counts(told) for told in columns.values())]


def _counts(told: Sequence[Told], action: str | None = None) -> str:
    own = [one for one in told if action in (None, one.truth.action)]
    return f"{sum(one.action_right for one in own)}, {sum(one.object_right for one in own)}"
