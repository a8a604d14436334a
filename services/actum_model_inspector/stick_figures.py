"""Stick figures: joints in orthographic projection, seen from in front, a little from the actor's left and above."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import to_rgba

from actum.arrays import Floats
from actum.skeletons import INDEX, JOINTS, PARTS
from actum.standard_body import BONES
from actum_model_inspector.style import INK, LEFT, PAPER, RIGHT

AZIMUTH_RAD = np.deg2rad(20.0)  # of the view: an arm stretched forward does not hide behind its own hand
ELEVATION_RAD = np.deg2rad(12.0)  # of the view, for the same reason
HEIGHT_M = 1.75  # from the feet to a raised hand: the height that must fit into a figure's size
MIDDLE_M = -0.22  # height of the middle between feet and raised hand above the torso
HEAD_M = 0.11  # radius of a head
LONGEST_ARROW_M = 0.9  # of a map's fastest joint: an arrow about as long as a leg
SHORTEST_ARROW_M = 0.06  # shorter arrows are left out: only their heads would be seen

_HIP_TO_TORSO_M = 0.24  # height difference
_SIDE_M = {
    "hip": (0.10, 0.0, 0.0), "knee": (0.11, -0.42, 0.02), "foot": (0.12, -0.86, 0.0),
    "shoulder": (0.18, 0.46, 0.0), "elbow": (0.22, 0.19, -0.02), "hand": (0.24, -0.12, 0.05),
}  # fmt: skip
"""Joints of the left side of somebody who stands: to the left, up and forward from the hips' middle."""
_MIDLINE_M = {"torso": (0.0, 0.24, 0.0), "neck": (0.0, 0.48, 0.0), "head": (0.0, 0.68, 0.0)}


def _standing(joint: str) -> tuple[float, float, float]:
    if joint in _MIDLINE_M:
        left, up, forward = _MIDLINE_M[joint]
    else:
        side, name = joint.split("_")
        left, up, forward = _SIDE_M[name]
        left = left if side == "left" else -left
    return left, up - _HIP_TO_TORSO_M, forward


STANDING = np.array([_standing(joint) for joint in JOINTS])
"""Joints of somebody who stands, (15, 3), metres to the left, up and forward from the torso."""


@dataclass(frozen=True)
class StickFigure:
    """Which of a figure's points are joined by lines.

    Attributes:
        bones: the indices of the two points of each line.
        head: the index of the point that is drawn as a head, if there is one.
    """

    bones: tuple[tuple[int, int], ...]
    head: int | None


@dataclass(frozen=True)
class Pen:
    """The line style of figures.

    Attributes:
        width: of the lines, in typographic points.
        colour: of all bones; by the actor's side where None.
        strength: the opacity, 0 to 1.
        zorder: Matplotlib's: the larger is drawn above.
    """

    width: float = 1.2
    colour: str | None = None
    strength: float = 1.0
    zorder: float = 2.0


WHOLE_BODY = StickFigure(tuple((parent, child) for parent, child, _ in BONES), INDEX["head"])
ONE_LIMB = StickFigure(((0, 1), (1, 2)), None)


def projected(points: Floats) -> Floats:
    """Project points (…, 3), metres to the actor's left, up and forward, to (…, 2), metres right and up on the page."""
    left, up, forward = np.moveaxis(points, -1, 0)
    right = left * np.cos(AZIMUTH_RAD) - forward * np.sin(AZIMUTH_RAD)
    towards = forward * np.cos(AZIMUTH_RAD) + left * np.sin(AZIMUTH_RAD)
    return np.stack([right, up * np.cos(ELEVATION_RAD) - towards * np.sin(ELEVATION_RAD)], axis=-1)


def laid_out(points: Floats, places: Floats, size: float) -> Floats:
    """Return figures' points (n, k, 3) in coordinates of the page, x right and y down, shape (n, k, 2).

    Args:
        points: (n, k, 3), metres, relative to the torso.
        places: (n, 2), x and y of each figure's middle.
        size: how high a figure of `HEIGHT_M` is.
    """
    flat = (projected(points) - [0.0, MIDDLE_M]) * (size / HEIGHT_M)
    laid: Floats = places[:, None, :] + flat * [1.0, -1.0]
    return laid


def draw_figures(
    axes: Axes, points: Floats, places: Floats, size: float, figure: StickFigure = WHOLE_BODY, pen: Pen = Pen()
) -> None:
    """Draw figures.

    Args:
        axes: whose y goes down.
        points: (n, k, 3), metres, relative to the torso; NaN where missing.
        places: (n, 2), x and y of each figure's middle.
        size: how high a figure may be.
        figure: which points are joined.
        pen: the line style.
    """
    laid, colours = laid_out(points, places, size), _colours(points, figure, pen)
    lines = laid[:, figure.bones]
    known = np.isfinite(lines).all(axis=(2, 3))
    bones = LineCollection(
        list(lines[known]), colors=colours[known], linewidths=pen.width, capstyle="round", zorder=pen.zorder
    )
    axes.add_collection(bones)
    if figure.head is not None:
        _draw_heads(axes, laid[:, figure.head], 2 * HEAD_M * size / HEIGHT_M, pen)


def draw_arrows(axes: Axes, points: Floats, steps_m: Floats, places: Floats, size: float, width_in: float) -> None:
    """Draw arrows from joints.

    Args:
        axes: whose y goes down.
        points: (n, 15, 3), as `draw_figures` takes them.
        steps_m: (n, 15, 3), the arrows, in metres on the figure.
        places: (n, 2), x and y of each figure's middle.
        size: how high a figure may be.
        width_in: of the arrows' shafts, inches.
    """
    tails = laid_out(points, places, size).reshape(-1, 2)
    arrows = laid_out(points + steps_m, places, size).reshape(-1, 2) - tails
    moving = np.hypot(*arrows.T) > SHORTEST_ARROW_M * size / HEIGHT_M
    colours = np.tile([_side(joint) for joint in JOINTS], len(points))
    axes.quiver(
        *tails[moving].T, *arrows[moving].T, color=colours[moving], angles="xy", scale_units="xy", scale=1,
        units="inches", width=width_in, headwidth=4, headlength=4, headaxislength=3.6, zorder=3,
    )  # fmt: skip


def _draw_heads(axes: Axes, centres: Floats, diameter: float, pen: Pen) -> None:
    known = np.isfinite(centres).all(axis=1)
    heads = EllipseCollection(
        [diameter], [diameter], [0.0], units="xy", offsets=centres[known], offset_transform=axes.transData,
        facecolors=PAPER, edgecolors=to_rgba(pen.colour or INK, pen.strength), linewidths=pen.width, zorder=pen.zorder,
    )  # fmt: skip
    axes.add_collection(heads)


def _colours(points: Floats, figure: StickFigure, pen: Pen) -> Floats:
    """Return the colour of each bone of each figure, (n, bones, 4)."""
    if pen.colour is not None:
        names = [[pen.colour] * len(figure.bones)] * len(points)
    elif figure is ONE_LIMB:
        names = [[_side(part)] * len(figure.bones) for part in _parts(points)]
    else:
        names = [[_side(JOINTS[child]) for _, child in figure.bones]] * len(points)
    colours = [to_rgba(name, pen.strength) for row in names for name in row]
    return np.array(colours).reshape(len(points), len(figure.bones), 4)


def _side(name: str) -> str:
    if name.endswith(("shoulder", "hip")):
        return INK
    return RIGHT if name.startswith("right") else LEFT if name.startswith("left") else INK


def _parts(points: Floats) -> list[str]:
    """Return the body part of each limb (n, 3, 3), the one whose first joint, when standing, is nearest to its own."""
    first = np.array([STANDING[joints[0]] for joints in PARTS.values()])
    distances = np.linalg.norm(points[:, None, 0] - first, axis=-1)
    return [tuple(PARTS)[index] for index in distances.argmin(axis=1)]


def standing(count: int) -> Floats:
    """Return the joints of somebody who stands, repeated, shape (count, 15, 3)."""
    return np.broadcast_to(STANDING, (count, *STANDING.shape))
