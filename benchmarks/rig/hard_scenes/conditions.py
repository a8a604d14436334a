"""Conditions that make a scene harder: the arrangement of the objects, and the quality of the images."""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated

from pydantic import Field

from scene_simulator.parameters import ObjectParameters, Parameters, Section, TableParameters

SIZE_TO_SPACING = 0.875
"""Largest width of an object as a share of the spacing: objects in a closer row are scaled down."""

ROW_BEHIND_EDGE_M = 0.05
"""Distance from the table's near edge to a row of objects."""
ROW_DEPTH_M = 0.02
"""Range of depths of the objects in a row."""

Length = Annotated[float, Field(gt=0, le=5)]


class Conditions(Section):
    """The conditions of one scene; by default it is as its parameters describe it.

    Attributes:
        spacing_m: distance between the middles of neighbouring objects, which then stand in a row.
        distance_m: distance of the person from the row of objects, which then is at the table's near edge.
        pantomime_m: distance of a pantomime's path from the nearest object's middle; up to 5 cm more; None: far away.
        clutter: number of shapes, edges and false markers on the wall, and the same number on the table.
        defocus_sd_px: standard deviation of the camera's blur.
        exposure_s: exposure time, at most a frame interval; causes motion blur.
        unread_share: share of images in which a marker cannot be read, drawn independently for each marker.
        covers_marker: whether the hand hides the marker of the object that it holds.
    """

    spacing_m: Length | None = None
    distance_m: Length | None = None
    pantomime_m: Length | None = None
    clutter: int = Field(0, ge=0)
    defocus_sd_px: float = Field(0.0, ge=0)
    exposure_s: float = Field(0.0, ge=0)
    unread_share: float = Field(0.0, ge=0, le=1)
    covers_marker: bool = False

    def arranged(self, parameters: Parameters) -> Parameters:
        """Return the parameters with objects and person placed by the conditions."""
        objects = parameters.objects if self.spacing_m is None else _in_a_row(parameters.objects, self.spacing_m)
        if self.distance_m is None:
            return parameters.model_copy(update={"objects": objects})
        row_z_m = parameters.table.near_z_m + ROW_BEHIND_EDGE_M
        far_z_m = row_z_m + self.distance_m - parameters.actor.stand_off_mean_sd_m[0]
        return parameters.model_copy(
            update={
                "objects": objects.model_copy(update={"place_z_range_m": (row_z_m, row_z_m + ROW_DEPTH_M)}),
                "table": TableParameters.model_validate(parameters.table.model_dump() | {"far_z_m": far_z_m}),
            }
        )


PLAIN = Conditions()


@cache
def load_conditions() -> Mapping[str, Conditions]:
    """Read the named conditions from `conditions.toml` beside this file."""
    text = Path(__file__).with_name("conditions.toml").read_text(encoding="utf-8")
    return {name: Conditions.model_validate(section) for name, section in tomllib.loads(text).items()}


def _in_a_row(objects: ObjectParameters, spacing_m: float) -> ObjectParameters:
    """Return the parameters of objects side by side, scaled down where they would touch."""
    widest_m = max(item.size_m[0] for item in objects.items)
    scale = min(1.0, SIZE_TO_SPACING * spacing_m / widest_m)
    middle_m = sum(objects.place_z_range_m) / 2
    items = [item.model_copy(update={"size_m": tuple(scale * side for side in item.size_m)}) for item in objects.items]
    return objects.model_copy(
        update={
            "items": tuple(items),
            "marker_size_m": scale * objects.marker_size_m,
            "place_x_m": (-spacing_m, 0.0, spacing_m),
            "place_jitter_x_sd_m": 0.0,
            "place_z_range_m": (middle_m - ROW_DEPTH_M / 2, middle_m + ROW_DEPTH_M / 2),
        }
    )
