"""A small model of each kind, made by hand rather than trained."""

import numpy as np

from actum.som import Som
from som_classifier.body_movement import BodyMovement
from som_classifier.convolutions import COORDINATES, FILTERS, Convolutions, SecondOpinion
from som_classifier.first_layer import MAP_INPUTS, FirstMaps
from som_classifier.model import Model
from som_classifier.paper_model import PaperMetadata, PaperModel
from som_classifier.pyramid_metadata import PyramidMetadata
from som_classifier.pyramid_model import PyramidModel
from som_classifier.second_layer import ActionMap
from som_classifier.stage_discriminants import StageDiscriminants
from som_classifier.supervised import SupervisedLayer
from som_classifier.verifier import Verifier

POINTS = 3
LEVELS = [1, 2]
FRACTIONS = [0.5, 1.0]
UNITS = 4 * 9
PROVENANCE: dict[str, object] = {
    "labels": ["pull", "push"],
    "preset": "handmade",
    "parameters": {"layer1": {"rows": 3, "radius": (1.5, 0.7)}},
    "seed": 7,
    "persons": ["1", "3"],
    "samples": 60,
    "data_digest": "abc",
    "actum_version": "0.1.0",
}


def paper_model(**changes: object) -> PaperModel:
    """A 3×3 map; the second map knows the way down its first column and the way up, each with its own neuron."""
    layer1 = Som.random(3, 3, 9, np.random.default_rng(0))
    down, up = [0.0, 0.0, 1.0, 0.0, 2.0, 0.0], [2.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    posture = {"axes": "posture", "origin": "hips", "attention": "moving"}
    about = PROVENANCE | posture | {"centre_contrast": 0.1, "points": POINTS, "contrast": 4.0} | changes
    metadata = PaperMetadata.model_validate(about)
    return PaperModel(layer1, Som(1, 2, np.array([down, up])), SupervisedLayer(np.eye(2)), metadata)


def pyramid_model(**changes: object) -> PyramidModel:
    """Three maps of 3×3 units, two stages, a 3×3 map of actions, all drawn at random."""
    about = {
        "posture_contrast": 0.5, "velocity_contrast": 0.1, "arm_contrast": 0.2, "arm_shares": [0.4, 0.1],
        "mirrors": True,
        "levels": LEVELS, "overlap": 0.25, "fractions": FRACTIONS, "log_duration_mean": 0.5, "log_duration_sd": 0.4,
        "concept_contrast": 2.0, "gains": [4.0, 8.0], "verification": [10.0, -3.0],
        "least_likeness": 0.2, "least_found_likeness": 0.3, "opinion_weight": 0.5,
        "usual_log_errors": [-2.5, -2.0],
        "usual_movements": [[-3.0, -3.5], [-3.0, -3.0]], "most_movement_above": [1.0, 1.0], "least_movement_m": 0.0,
    }  # fmt: skip
    metadata = PyramidMetadata.model_validate(PROVENANCE | about | changes)
    rng = np.random.default_rng(0)
    maps = [Som(3, 3, rng.normal(size=(9, dim)).astype(np.float32)) for dim in (45, 45, 12, 2)]
    axes = rng.normal(size=(2, sum(LEVELS) * UNITS, 2)).astype(np.float32)
    first = FirstMaps(dict(zip(MAP_INPUTS, maps, strict=False)), metadata.contrasts, (0.4, 0.1))
    stages = StageDiscriminants(
        axes,
        rng.normal(size=(2, 2)).astype(np.float32),
        tuple(metadata.fractions),
        metadata.log_duration_mean,
        metadata.log_duration_sd,
    )
    action_map = ActionMap(maps[3], metadata.concept_contrast, (0.1 * rng.random(9)).astype(np.float32))
    layer3 = SupervisedLayer.random(2, 9, rng)
    coordinates = rng.integers(2, size=(FILTERS, COORDINATES)).astype(np.float32)
    convolutions = Convolutions(coordinates, rng.normal(size=(FILTERS, 2)).astype(np.float32))
    looked_at, *offsets = (rng.normal(size=shape).astype(np.float32) for shape in ((2 * FILTERS, 2), 2, 2))
    opinion = SecondOpinion(convolutions, looked_at, offsets[0], metadata.opinion_weight)
    least = metadata.least_likeness, metadata.least_found_likeness
    calibrated = metadata.usual_log_errors, *metadata.verification, *least
    verifier = Verifier(axes[1], looked_at, offsets[1], *calibrated)
    body = BodyMovement(metadata.usual_movements, metadata.most_movement_above, metadata.least_movement_m)
    return PyramidModel(first, stages, opinion, verifier, body, action_map, layer3, metadata)


KINDS: dict[str, type[Model]] = {"paper": PaperModel, "pyramid": PyramidModel}


def model_of(kind: str, **changes: object) -> Model:
    return paper_model(**changes) if kind == "paper" else pyramid_model(**changes)
