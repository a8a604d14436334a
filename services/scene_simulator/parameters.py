"""The frozen parameters of the scene, as read from `scene.toml` beside this file."""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Literal

from pydantic import BaseModel, ConfigDict

Pair = tuple[float, float]
Triple = tuple[float, float, float]


class Section(BaseModel):
    """A table of the file; an unknown entry is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class CameraParameters(Section):
    """The pinhole camera; level, so that up is -y in its frame."""

    width: int
    height: int
    focal_px: float
    height_m: float
    frame_rate_hz: int

    @property
    def half_view(self) -> float:
        """Largest |x| / z that the camera sees."""
        return self.width / 2 / self.focal_px


class TableParameters(Section):
    """The table: its top's height above the floor, distances from the camera, and size."""

    height_m: float
    near_z_m: float
    far_z_m: float
    width_m: float
    thickness_m: float


class ObjectItem(Section):
    """One object: its marker's id is its own; `size_m` is width, height, depth."""

    id: int
    name: str
    shape: Literal["cup", "cuboid"]
    size_m: Triple
    bgr: tuple[int, int, int]


class ObjectParameters(Section):
    """The objects and their possible positions."""

    marker_size_m: float
    place_x_m: tuple[float, ...]
    place_jitter_x_sd_m: float
    place_z_range_m: Pair
    yaw_sd_deg: float
    items: tuple[ObjectItem, ...]


class ActorParameters(Section):
    """Distributions of people's proportions and habits."""

    height_mean_sd_m: Pair
    left_handed_probability: float
    heading_sd_deg: float
    stand_off_mean_sd_m: Pair
    stand_x_sd_m: float
    tempo_mean_sd: Pair
    lean_mean_sd_deg: Pair
    twist_gain_mean_sd: Pair
    elbow_out_mean_sd: Pair
    arc_mean_sd: Pair
    noise_mean_sd: Pair
    pointing_bias_sd_deg: float


class TrialParameters(Section):
    """Distributions over one person's repetitions."""

    duration_mean_sd_s: Pair
    duration_range_s: Pair
    reach_share_mean_sd: Pair
    grasp_share_mean_sd: Pair
    effect_share_mean_sd: Pair
    pointing_reach_share_mean_sd: Pair
    heading_sd_deg: float
    stance_sd_m: float
    rest_side_m: float
    rest_inset_range_m: Pair
    rest_height_m: float
    rest_sd_m: float
    arc_height_range_m: Pair
    arc_side_sd_m: float
    grasp_sd_m: float
    grasp_side_range_deg: Pair
    grasp_clearance_m: float
    finger_overlap_range_m: Pair
    effect_distance_range_m: Pair
    pull_distance_range_m: Pair
    effect_direction_sd_deg: float
    riser_height_range_m: Pair
    riser_probability: float
    put_clearance_m: float
    pointing_stand_off_range_m: Pair
    pointing_sd_deg: float


class PauseParameters(Section):
    """The pause between two repetitions."""

    lead_in_s: float
    reset_range_s: Pair
    return_share: float
    hop_m: float


class PausesParameters(Section):
    """What happens between the actions of a person with everyday doings."""

    rest_range_s: Pair
    at_once_probability: float
    most_doings: int


class EverydayParameters(Section):
    """The pauses that there are to choose from."""

    long: PausesParameters
    short: PausesParameters


class SwayParameters(Section):
    """The sway of quiet standing."""

    pelvis_sd_m: float
    lean_sd_deg: float
    frequency_range_hz: Pair


class NoiseParameters(Section):
    """The skeleton tracker's noise."""

    time_constant_s: float
    common_sd_m: float
    excursions_per_s: float
    excursion_s: float
    excursion_sd_m: float
    joint_sd_m: dict[str, float]


class ImageParameters(Section):
    """The colour camera's noise and compression."""

    jpeg_quality: int
    grey_noise_sd: float
    blur_sd_px: float


class Parameters(Section):
    """The content of `scene.toml`."""

    camera: CameraParameters
    table: TableParameters
    objects: ObjectParameters
    actor: ActorParameters
    trial: TrialParameters
    pause: PauseParameters
    everyday: EverydayParameters
    sway: SwayParameters
    noise: NoiseParameters
    image: ImageParameters

    @property
    def table_y_m(self) -> float:
        """Position of the table top in the camera frame (y down)."""
        return self.camera.height_m - self.table.height_m

    def moved(self, right_m: float, away_m: float) -> "Parameters":
        """Return the parameters with table and objects further to the camera's right, and further away from it."""
        table, objects = self.table, self.objects
        near_z_m, far_z_m = table.near_z_m + away_m, table.far_z_m + away_m
        near, far = objects.place_z_range_m
        placed = {
            "place_x_m": tuple(x + right_m for x in objects.place_x_m),
            "place_z_range_m": (near + away_m, far + away_m),
        }
        return self.model_copy(
            update={
                "table": table.model_copy(update={"near_z_m": near_z_m, "far_z_m": far_z_m}),
                "objects": objects.model_copy(update=placed),
            }
        )


@cache
def load_parameters() -> Parameters:
    """Read the package's `scene.toml`."""
    text = files(__package__).joinpath("scene.toml").read_text(encoding="utf-8")
    return Parameters.model_validate(tomllib.loads(text))
