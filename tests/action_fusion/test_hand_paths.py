"""When a thing left where it was, looked up instant by instant."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from action_fusion.hands import FURTHEST_SHARE, furthest


@given(st.data(), st.integers(1, 20), st.floats(0.1, 5.0))
def test_it_was_furthest_last_within_the_time_asked_for(data, n, within) -> None:
    places = data.draw(arrays(float, (n, 3), elements=st.floats(-1, 1, width=32)))
    stamps = np.cumsum(data.draw(arrays(float, n, elements=st.floats(0.0625, 1.0, width=32))))
    for i, last in enumerate(furthest(places, stamps, within)):
        recent = [k for k in range(i + 1) if stamps[k] >= stamps[i] - within]
        away = {k: float(np.linalg.norm(places[k] - places[i])) for k in recent}
        assert last == max(k for k in recent if away[k] >= FURTHEST_SHARE * max(away.values()))


def test_of_nothing_nothing_is_found() -> None:
    assert len(furthest(np.empty((0, 3)), np.empty(0), 1.0)) == 0
