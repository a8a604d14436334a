"""The tracker's benchmark: markers are drawn where it says, and every row of its tables runs."""

import numpy as np
import pytest
from benchmarks.tracker.marker_scenes import Scene
from benchmarks.tracker.rows import OURS, ROWS

pytestmark = pytest.mark.thorough

SCENE = Scene("DICT_4X4_50", 40, "plain", 1)


@pytest.fixture(scope="module", params=ROWS)
def found(request):
    """What a row finds in the first image: corners by id."""
    with ROWS[request.param].running(SCENE.family, [marker.printed.id for marker in SCENE.truth[0]]) as detect:
        return request.param, {marker.id: marker.corners_px for marker in detect(0, SCENE.images[0])}


def test_every_row_finds_markers_near_where_they_were_drawn(found) -> None:
    _, corners_px = found
    near = [
        np.abs(corners_px[marker.printed.id] - marker.corners_px).max() < 4.0
        for marker in SCENE.truth[0]
        if marker.printed.id in corners_px
    ]
    assert len(near) >= 9 and all(near)


def test_ours_finds_them_exactly_where_they_were_drawn(found) -> None:
    name, corners_px = found
    if name == OURS:
        off_px = [np.abs(corners_px[marker.printed.id] - marker.corners_px).max() for marker in SCENE.truth[0]]
        assert max(off_px) < 0.15


def test_what_a_row_leaves_out_is_back_after_it() -> None:
    for row in ROWS.values():
        before = [getattr(where, name) for where, name, _ in row.without]
        with row.running(SCENE.family, [1]):
            pass
        assert [getattr(where, name) for where, name, _ in row.without] == before
