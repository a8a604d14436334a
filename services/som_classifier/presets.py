"""The parameters of training, in named sets. Names of fields are stored with each model and do not change."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from actum.som import Schedule
from som_classifier.attention import CHOICES, MOVING, PostureInput
from som_classifier.spotting.spotting_preset import SpottingPreset


@dataclass(frozen=True)
class MapTraining:
    """A map's size and its sequential training.

    Attributes:
        rows: of the grid.
        cols: of the grid.
        steps: adaptations to one input each.
        schedule: of adaptation strength and neighbourhood radius.
    """

    rows: int
    cols: int
    steps: int
    schedule: Schedule


@dataclass(frozen=True)
class BodyVariation:
    """Augmentation by other bodies: each sample is also shown as people of other proportions would have acted.

    Attributes:
        count: copies of each sample.
        build_sd: standard deviation of the logarithm of their bones' lengths.
        tempo: the factor by which their velocities differ from the sample's.
    """

    count: int
    build_sd: float
    tempo: float


@dataclass(frozen=True)
class Prior:
    """Prior for calibration, from models of other people's actions; its weight is largest with the fewest people.

    Attributes:
        people: its weight, as a number of people beyond the first of those trained on.
        gain: inverse temperature of the softmax of cosines.
        gain_where_inferred: the same where distances were inferred from an image and a standard body's size.
        verification: of the logistic regression of whether a segment is a true instance of its action: slope on its
            likeness where that of untaught actions reaches 1 (it falls with the root of this), and intercept.
        least_likeness: the likenesses that true instances exceed, shares `known_share` and `found_share` of them.
        least_from_one: the same where no person has performed an action more than once: they are lower then.
        log_error: the mean log(d²) of postures from the posture map that a person not trained on may well reach with a
            trained action, d in metres over all joints of a standard body.
        threshold: completeness that what is found without marks must exceed.
        precision: share of the segments found in which any action is done.
        precision_segments: its weight, as a number of segments found.
        movement_above: by how much the logarithm of legs' or trunk's movement exceeds its action's mean in hardly any
            instance.
    """

    people: float
    gain: float
    gain_where_inferred: float
    verification: tuple[float, float]
    least_likeness: tuple[float, float]
    least_from_one: tuple[float, float]
    log_error: float
    threshold: float
    precision: float
    precision_segments: float
    movement_above: float


@dataclass(frozen=True)
class ConvolutionPreset:
    """Of the second opinion and the verifier.

    Attributes:
        biases: of each filter.
        shrinkage: of the ridge regression on their features, in units of the mean squared length of these.
        opinion_weight: of the second opinion's scores beside those of the discriminants.
        verifier_weight: of the scores on the features in likeness, beside those on the pyramid's vectors.
    """

    biases: int
    shrinkage: float
    opinion_weight: float
    verifier_weight: float


@dataclass(frozen=True)
class Preset:
    """Everything that a training depends on beside its samples and its seed.

    Attributes:
        kind: of the models that are trained: a key of the tables of models and of trainings.
        choices: the values of each setting that a user may change, by its name.
        name: that it is chosen by.
    """

    kind: ClassVar[str]
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    name: str

    def changed(self, settings: Mapping[str, Any]) -> Self:
        """Return the preset with other settings, each one of `choices`."""
        return replace(self, **settings)


@dataclass(frozen=True)
class PaperPreset(Preset):
    """The preset of the paper's recogniser.

    Attributes:
        posture: the first map's input.
        layer1: the first map.
        layer2: the second map.
        centre_contrast: the first map's contrast in units of the training postures' median squared distance to their
            winners.
        relative_contrast: the second map's contrast in units of the training vectors' median squared distance
            to their nearest neighbour.
        beta: adaptation strength of the third layer.
        epochs: how often the third layer is shown every training vector.
    """

    kind: ClassVar[str] = "paper"
    choices = CHOICES
    posture: PostureInput
    layer1: MapTraining
    layer2: MapTraining
    centre_contrast: float
    relative_contrast: float
    beta: float
    epochs: int

    def changed(self, settings: Mapping[str, Any]) -> Self:
        """Return the preset with another input of the first map."""
        return replace(self, posture=replace(self.posture, **settings))


@dataclass(frozen=True)
class PyramidPreset(Preset):
    """The preset of the default recogniser.

    Attributes:
        units: rows and columns of each map of the first layer.
        unit_epochs: epochs of its batch training.
        unit_radius: the first and the last neighbourhood radius of that training, grid units.
        relative_contrast: of its soft activity, in units of the median squared distance to the winner.
        arm_shares: the sum of the arm map's activity for the acting arm, and for the other one; for each of the other
            maps the sum is 1.
        levels: the number of the pyramid's cells on each level.
        overlap: how far each cell reaches over its borders, as a fraction of its length.
        turns_deg: augmentation: rotations of each sample about the vertical.
        leans_deg: augmentation: the tilt backwards that is combined with each rotation where depth was inferred from
            an image: there a body's tilt is uncertain.
        others: augmentation by other bodies.
        others_of_few: the same where samples are of `few_people` at most, which hardly show how people differ.
        few_people: see `others_of_few`.
        stages: the shares of an action that the discriminants of each stage are trained on; the last is the whole.
        shrinkage: of the discriminants' covariance, in units of the mean squared length of the pooled vectors.
        held_out_share: the weight of the cross-validated scores in the scores that the action map is trained on; the
            rest is that of the training scores.
        fewest_scores: the least number of score vectors that the upper layers are trained on; mixup makes missing ones.
        least_share: the smallest weight, in such a mixture, of the sample that gives it its action.
        concepts: rows and columns of the action map.
        concept_epochs: epochs of its batch training.
        concept_radius: the first and the last neighbourhood radius of that training, grid units.
        relative_concept_contrast: of its soft activity, in units of the scores' mean variance within an action.
        beta: adaptation strength of the third layer.
        epochs: how often the third layer is shown every training vector.
        convolutions: of the second opinion and the verifier.
        known_share: the share of true instances that are to count as known.
        found_share: the share of those that are to be published where nobody marked them. Their variants count, too,
            of other bodies and turned, which are less like: of those as measured nearly all are.
        background: windows of movement that nobody taught, which the verifier holds the actions against.
        prior: for calibration.
        spotting: of the search for actions without marks.
    """

    kind: ClassVar[str] = "pyramid"
    units: tuple[int, int]
    unit_epochs: int
    unit_radius: tuple[float, float]
    relative_contrast: float
    arm_shares: tuple[float, float]
    levels: tuple[int, ...]
    overlap: float
    turns_deg: tuple[float, ...]
    leans_deg: tuple[float, ...]
    others: BodyVariation
    others_of_few: BodyVariation
    few_people: int
    stages: tuple[tuple[float, ...], ...]
    shrinkage: float
    held_out_share: float
    fewest_scores: int
    least_share: float
    concepts: tuple[int, int]
    concept_epochs: int
    concept_radius: tuple[float, float]
    relative_concept_contrast: float
    beta: float
    epochs: int
    convolutions: ConvolutionPreset
    known_share: float
    found_share: float
    background: int
    prior: Prior
    spotting: SpottingPreset


PAPER = PaperPreset(
    name="paper",
    posture=PostureInput(axes="upright", origin="torso", attention=MOVING),
    layer1=MapTraining(30, 30, 100_000, Schedule(alpha=(0.1, 0.01), radius=(15.0, 3.0))),
    layer2=MapTraining(35, 35, 30_000, Schedule(alpha=(0.5, 0.02), radius=(17.5, 0.5))),
    centre_contrast=1.0,
    relative_contrast=0.15,
    beta=0.35,
    epochs=50,
)
"""The architecture of Gharaee, Gärdenfors and Johnsson (2017).

What the paper leaves open was chosen by cross-validation on training samples only: people 1, 3, 5, 7 and 9 of MSR
Action3D, and the demo's simulated training set.
"""

PYRAMID = PyramidPreset(
    name="pyramid",
    units=(18, 18),
    unit_epochs=12,
    unit_radius=(7.0, 0.6),
    relative_contrast=0.3,
    arm_shares=(0.36, 0.05),
    levels=(1, 2, 4),
    overlap=0.25,
    turns_deg=(-15.0, 15.0),
    leans_deg=(-10.0, 10.0),
    others=BodyVariation(2, build_sd=0.1, tempo=1.0),
    others_of_few=BodyVariation(8, build_sd=0.2, tempo=0.5),
    few_people=2,
    stages=((0.1, 0.2, 0.3, 0.4, 0.5), (0.3, 0.4, 0.5, 0.6, 0.7, 0.8), (1.0,)),
    shrinkage=0.15,
    held_out_share=0.5,
    fewest_scores=2_000,
    least_share=0.55,
    concepts=(25, 25),
    concept_epochs=20,
    concept_radius=(9.0, 0.8),
    relative_concept_contrast=40.0,
    beta=0.05,
    epochs=10,
    convolutions=ConvolutionPreset(biases=5, shrinkage=0.3, opinion_weight=0.75, verifier_weight=0.75),
    known_share=0.95,
    found_share=0.8,
    background=300,
    prior=Prior(
        people=4.0,
        gain=6.0,
        gain_where_inferred=4.2,
        verification=(4.9, -3.0),
        least_likeness=(0.20, 0.30),
        least_from_one=(0.15, 0.25),
        log_error=-2.5,
        threshold=0.5,
        precision=0.9,
        precision_segments=12.0,
        movement_above=1.0,
    ),
    spotting=SpottingPreset(
        interval_s=0.1,
        lag_s=0.2,
        overlap=0.15,
        duration_weight=0.1,
        windows=8,
        shortest_quantile=0.04,
        shrinkage=0.4,
        most_windows=5000,
        common_shares=(0.0, 0.3, 0.5),
        folds=3,
        thresholds=tuple(n / 20 for n in range(5, 19)),
        false_alarm_threshold=0.4,
    ),
)
"""The default. benchmarks/recognition says how its numbers were chosen, and on which people."""

DEFAULT = PYRAMID

PRESETS: dict[str, Preset] = {preset.name: preset for preset in (PYRAMID, PAPER)}
