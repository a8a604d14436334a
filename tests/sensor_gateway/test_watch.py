"""A camera that shows nothing is noticed: frozen, black; and it is tried again ever later."""

import numpy as np
import pytest

from actum.node import SECOND_NS
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.watch import BackOff, Watch

FRAME_NS = SECOND_NS // 20


def pictures(seed: int, count: int, level: int = 120, first: int = 0) -> list[Picture]:
    """A sensor's pictures of one level: no two are the same."""
    rng = np.random.default_rng(seed)
    return [
        Picture(np.clip(rng.normal(level, 2, (48, 64, 3)), 0, 255).astype(np.uint8), (first + i) * FRAME_NS)
        for i in range(count)
    ]


def complaints(stream: list[Picture]) -> list[str]:
    watch = Watch()
    return [(watch.complaint(picture) or "").partition(":")[0] for picture in stream]


def test_what_lives_is_not_complained_of() -> None:
    assert set(complaints(pictures(0, 60))) == {""}


def test_a_picture_that_stays_for_a_second_is_frozen_and_one_that_changes_again_is_not() -> None:
    [first, *_] = still = [Picture(pictures(0, 1)[0].image_bgr, i * FRAME_NS) for i in range(30)]
    assert complaints(still) == [""] * 20 + ["frozen"] * 10
    assert complaints([*still, *pictures(1, 3, first=30)])[-3:] == [""] * 3
    assert first.stamp_ns == 0


def test_darkness_is_noticed_after_half_a_second_though_its_noise_lives_on() -> None:
    dark = pictures(0, 20, level=2)
    assert complaints(dark) == [""] * 10 + ["black"] * 10
    assert complaints([*dark, *pictures(1, 2, first=20)])[-2:] == ["", ""]


def lost(watch: Watch, stream: list[Picture]) -> list[bool]:
    return [watch.complaint(picture) is not None and watch.lost for picture in stream]


def test_a_frozen_camera_is_lost_at_once() -> None:
    frozen = [Picture(pictures(0, 1)[0].image_bgr, i * FRAME_NS) for i in range(30)]
    assert lost(Watch(), frozen) == [False] * 20 + [True] * 10


@pytest.mark.parametrize("noisy", [True, False])
def test_a_black_camera_is_lost_after_five_seconds(noisy: bool) -> None:
    nothing = np.zeros((48, 64, 3), np.uint8)
    dark = pictures(0, 120, level=2) if noisy else [Picture(nothing, i * FRAME_NS) for i in range(120)]
    watch = Watch()
    assert lost(watch, dark) == [False] * 100 + [True] * 20
    watch.complaint(pictures(1, 1, first=120)[0])
    assert not watch.lost


def test_a_black_camera_that_is_opened_again_is_still_black_but_has_its_time() -> None:
    watch = Watch()
    for picture in pictures(0, 120, level=2):
        watch.complaint(picture)
    watch.opened()
    told = [(watch.complaint(picture) or "", watch.lost) for picture in pictures(1, 110, level=2, first=200)]
    assert all(complaint.startswith("black") for complaint, _ in told)
    assert [lost for _, lost in told] == [False] * 100 + [True] * 10


def test_a_dim_room_is_not_black() -> None:
    assert set(complaints(pictures(0, 40, level=25))) == {""}


def test_each_failure_doubles_the_wait_up_to_a_limit_and_a_success_ends_that() -> None:
    back_off = BackOff()
    waits_s = [back_off.failed() / SECOND_NS for _ in range(7)]
    assert waits_s == [0.5, 1, 2, 4, 8, 8, 8]
    back_off.worked()
    assert back_off.failed() == SECOND_NS // 2
