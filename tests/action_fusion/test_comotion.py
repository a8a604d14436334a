"""When, in the time just before each instant, a position was furthest from the one at that instant."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from action_fusion.tracks.comotion import FURTHEST_SHARE, instants_furthest_away


@given(st.data(), st.integers(1, 20), st.floats(0.1, 5.0))
def test_it_is_the_last_instant_about_furthest_away_within_the_time_asked_for(data, n, within) -> None:
    positions = data.draw(arrays(float, (n, 3), elements=st.floats(-1, 1, width=32)))
    stamps = np.cumsum(data.draw(arrays(float, n, elements=st.floats(0.0625, 1.0, width=32))))
    for i, last in enumerate(instants_furthest_away(positions, stamps, within, np.arange(n))):
        recent = [k for k in range(i + 1) if stamps[k] >= stamps[i] - within]
        away = {k: float(np.linalg.norm(positions[k] - positions[i])) for k in recent}
        assert last == max(k for k in recent if away[k] >= FURTHEST_SHARE * max(away.values()))
