"""Joints go into an array and come back as they were."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from actum.arrays import joints_to_array, joints_to_list

NUMBER = st.floats(-1e6, 1e6)
JOINT = st.one_of(st.none(), st.lists(NUMBER, min_size=3, max_size=3))


@given(st.lists(JOINT, min_size=1, max_size=15))
def test_what_was_listed_is_listed_again(joints: list[list[float] | None]) -> None:
    array = joints_to_array(joints)
    assert array.shape == (len(joints), 3)
    assert joints_to_list(array) == joints


def test_a_missing_joint_is_nan_in_the_array() -> None:
    assert np.isnan(joints_to_array([None, [1.0, 2.0, 3.0]])).all(axis=1).tolist() == [True, False]
