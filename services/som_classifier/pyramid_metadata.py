"""The metadata of the default recogniser's model files."""

from typing import Annotated, Literal

from pydantic import Field

from actum.skeletons import JOINTS
from som_classifier.body_movement import PARTS
from som_classifier.model import ModelMetadata
from som_classifier.spotting.spotted import Finite
from som_classifier.spotting.spotting_model import Positive, PyramidSpottingMetadata

CONTRASTS = {"postures": "posture_contrast", "velocities": "velocity_contrast", "arms": "arm_contrast"}
"""The field of each map's contrast, by the name of the map in the first layer."""


class PyramidMetadata(ModelMetadata):
    """What a file of the default recogniser holds beside the weights; field names are keys of the stored JSON.

    Attributes:
        posture_contrast: of the posture map's soft activity, in squared metres.
        velocity_contrast: of the velocity map's soft activity, in its squared distance.
        arm_contrast: of the arm map's soft activity, in its squared distance.
        arm_shares: the sum of the arm map's activity for the acting arm, and for the other one.
        mirrors: whether an action of the left arm is read as its mirror image.
        levels: the number of the pyramid's cells on each level.
        overlap: how far each cell reaches over its borders, as a fraction of its length.
        fractions: the share of an action that has been seen at each stage of the discriminants.
        log_duration_mean: mean of the logarithm of the training segments' durations (s).
        log_duration_sd: standard deviation of that logarithm.
        concept_contrast: of the action map's soft activity, in squared scores.
        gains: the inverse temperatures of the softmax that turns cosines into probabilities, by stage.
        verification: slope and intercept of the logistic regression of whether a segment is a true instance of its
            action on its likeness.
        least_likeness: with less a segment may be none of the trained actions.
        least_found_likeness: with less a segment that nobody marked is not published.
        opinion_weight: of the second opinion's scores beside those of the discriminants.
        usual_log_errors: for each action, the mean log(d²) of its postures from the map of postures that a person not
            trained on may well reach, d in metres over all joints of a standard body.
        usual_movements: for each action, the mean logarithm of how much legs and trunk move (m).
        most_movement_above: how far that of a segment may lie above it, for legs and trunk.
        least_movement_m: how far everybody moves who does one of the actions, at least.
        spotting: of the search for actions without marks; None where the model was not trained for that.
        updated_from: the id of the model whose maps these are, and whose search but for actions added since; None where
            they are of this training.
    """

    kind: Literal["pyramid"] = "pyramid"
    posture_contrast: Positive
    velocity_contrast: Positive
    arm_contrast: Positive
    arm_shares: Annotated[list[Positive], Field(min_length=2, max_length=2)]
    mirrors: bool
    levels: Annotated[list[Annotated[int, Field(ge=1)]], Field(min_length=1)]
    overlap: Annotated[float, Field(ge=0, le=1)]
    fractions: Annotated[list[Annotated[float, Field(gt=0, le=1)]], Field(min_length=1)]
    log_duration_mean: Finite
    log_duration_sd: Positive
    concept_contrast: Positive
    gains: list[Positive]
    verification: Annotated[list[Finite], Field(min_length=2, max_length=2)]
    least_likeness: Finite
    least_found_likeness: Finite
    opinion_weight: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    usual_log_errors: list[Finite]
    usual_movements: list[Annotated[list[Finite], Field(min_length=len(PARTS), max_length=len(PARTS))]]
    most_movement_above: Annotated[list[Finite], Field(min_length=len(PARTS), max_length=len(PARTS))]
    least_movement_m: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    spotting: PyramidSpottingMetadata | None = None
    updated_from: str | None = None

    @property
    def contrasts(self) -> dict[str, float]:
        """The contrast of each map of the first layer, by the map's name."""
        return {name: getattr(self, field) for name, field in CONTRASTS.items()}

    def problem(self) -> str | None:
        """Return the first inconsistency within it, None where there is none."""
        actions = len(self.labels)
        if self.joint_order != list(JOINTS):
            return "its joint order is not this version's"
        lengths = len(set(self.labels)), len(self.gains), len(self.usual_log_errors), len(self.usual_movements)
        if lengths != (actions, len(self.fractions), actions, actions):
            return "its labels or its stages do not fit together"
        return None if self.spotting is None else self.spotting.problem(actions)
