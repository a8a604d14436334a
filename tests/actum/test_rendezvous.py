"""Who serves a sensor that several share: all agree, and nobody's leaving moves another's sensor."""

from hypothesis import given
from hypothesis import strategies as st

from actum.runtime.rendezvous import server_of

NAMES = st.lists(st.text("abcdefgh-0123456789", min_size=1, max_size=12), min_size=1, max_size=8, unique=True)


@given(NAMES, st.randoms())
def test_all_members_agree_in_whatever_order_they_see_each_other(names: list[str], random) -> None:
    seen = random.sample(names, len(names))
    assert server_of("kinect0", seen) == server_of("kinect0", names)


@given(NAMES, st.integers(0, 7))
def test_only_the_sensors_of_who_leaves_change_hands(names: list[str], which: int) -> None:
    gone = names[which % len(names)]
    left = [name for name in names if name != gone]
    for sensor in map(str, range(20)):
        before = server_of(sensor, names)
        assert before == gone or server_of(sensor, left) == before


@given(st.lists(st.text("abcdef", min_size=8, max_size=8), min_size=2, max_size=4, unique=True))
def test_sensors_are_spread_over_all_members(names: list[str]) -> None:
    assert {server_of(f"sensor{number}", names) for number in range(200)} == set(names)


def test_nobody_serves_where_there_is_nobody() -> None:
    assert server_of("kinect0", []) is None
