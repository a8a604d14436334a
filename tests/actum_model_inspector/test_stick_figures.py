import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure

from actum.skeletons import INDEX, JOINTS, PARTS
from actum.standard_body import BONES
from actum_model_inspector.stick_figures import (
    HEAD_M,
    HEIGHT_M,
    ONE_LIMB,
    STANDING,
    Pen,
    draw_figures,
    laid_out,
    projected,
)
from actum_model_inspector.style import LEFT, RIGHT
from people import lacking

metres = st.floats(-2, 2)


def bone_lines(points: np.ndarray, **how: object) -> LineCollection:
    axes = Figure().add_subplot()
    draw_figures(axes, points, np.zeros((len(points), 2)), 1.0, **how)
    (lines,) = (drawn for drawn in axes.collections if isinstance(drawn, LineCollection))
    return lines


def test_who_stands_is_seen_from_in_front() -> None:
    across, up = projected(STANDING).T
    assert across[INDEX["left_hand"]] > across[INDEX["torso"]] > across[INDEX["right_hand"]]
    assert up[INDEX["head"]] > up[INDEX["torso"]] > up[INDEX["left_foot"]]


def test_a_hand_stretched_forward_does_not_stay_where_it_is() -> None:
    before, after = projected(np.array([[-0.2, 0.2, 0.0], [-0.2, 0.2, 0.5]]))
    assert np.linalg.norm(after - before) > 0.15


@given(st.tuples(metres, metres, metres), st.tuples(metres, metres, metres))
def test_the_projection_is_linear_and_makes_nothing_longer(one: tuple[float, ...], other: tuple[float, ...]) -> None:
    one_m, other_m = np.array(one), np.array(other)
    assert projected(one_m + other_m) == pytest.approx(projected(one_m) + projected(other_m), abs=1e-9)
    assert np.linalg.norm(projected(one_m)) <= np.linalg.norm(one_m) + 1e-9


def test_a_figure_lies_within_its_place_feet_down() -> None:
    (laid,) = laid_out(STANDING[None], np.array([[3.0, 7.0]]), 1.0)
    assert np.abs(laid - [3.0, 7.0]).max() < 0.5
    assert laid[INDEX["left_foot"], 1] > laid[INDEX["head"], 1]


@pytest.mark.parametrize("size", [1.0, 3.0])
def test_a_head_is_drawn_in_the_figures_scale(size: float) -> None:
    axes = Figure().add_subplot()
    draw_figures(axes, STANDING[None], np.zeros((1, 2)), size)
    (heads,) = (drawn for drawn in axes.collections if isinstance(drawn, EllipseCollection))
    assert heads.get_widths() / size == pytest.approx(2 * HEAD_M / HEIGHT_M)
    assert heads.get_heights() == pytest.approx(heads.get_widths())


def test_every_bone_is_drawn_in_the_colour_of_its_side() -> None:
    lines = bone_lines(STANDING[None])
    assert len(lines.get_segments()) == len(BONES)
    colours = {tuple(colour) for colour in lines.get_colors()}
    assert len(colours) == 3


def test_a_missing_joint_leaves_out_the_bones_that_end_in_it() -> None:
    without_hand = lacking(STANDING, "left_hand")
    assert len(bone_lines(without_hand[None]).get_segments()) == len(BONES) - 1


def test_one_colour_for_all_where_the_pen_has_one() -> None:
    assert {tuple(colour) for colour in bone_lines(STANDING[None], pen=Pen(colour="#ff0000")).get_colors()} == {
        (1.0, 0.0, 0.0, 1.0)
    }


@pytest.mark.parametrize(("part", "colour"), [("right_arm", RIGHT), ("left_leg", LEFT)])
def test_three_joints_are_coloured_by_the_side_they_belong_to(part: str, colour: str) -> None:
    limb = STANDING[list(PARTS[part])]
    lines = bone_lines(limb[None], figure=ONE_LIMB)
    expected = bone_lines(limb[None], figure=ONE_LIMB, pen=Pen(colour=colour))
    assert np.array(lines.get_colors()) == pytest.approx(np.array(expected.get_colors()))


def test_who_stands_has_every_joint_relative_to_the_torso() -> None:
    assert STANDING.shape == (len(JOINTS), 3)
    assert STANDING[INDEX["torso"]].tolist() == [0, 0, 0]
