"""Several people side by side in one stream."""

from itertools import islice

import pytest

from actum.messages import Image, Message, Skeleton, Truth
from scene_simulator.everyday import Everyday
from scene_simulator.group import Group
from scene_simulator.programme import balanced_programme

PROGRAMMES = [balanced_programme(1, 1, actor)[:2] for actor in range(4)]
EVERYDAY = Everyday(("gesture", "half_reach", "scratch_arm"), least_s=40)


def frames_of(programmes=PROGRAMMES) -> list[list[Message]]:
    return list(Group(programmes, 5, 1, everyday=EVERYDAY, start_ns=10**15).frames())


@pytest.fixture(scope="module")
def frames() -> list[list[Message]]:
    return frames_of()


def test_the_same_arguments_give_the_same_messages(frames: list[list[Message]]) -> None:
    assert frames == frames_of()


def test_each_frame_has_one_skeleton_message_of_all_people(frames: list[list[Message]]) -> None:
    for number, messages in enumerate(frames):
        skeletons = [message for message in messages if isinstance(message, Skeleton)]
        assert len(skeletons) == 1
        assert {message.stamp_ns for message in messages} == {10**15 + round(number * 1e9 / 30)}
        if number < 40 * 30:
            assert [agent.agent for agent in skeletons[0].agents] == [1, 2, 3, 4]


def test_people_stand_side_by_side_in_view(frames: list[list[Message]]) -> None:
    for messages in frames[: 40 * 30 : 10]:
        pelvises = [agent.joints[2] for agent in messages[-1].agents]
        across = [x / z for x, _, z in pelvises]
        assert across == sorted(across)
        assert max(abs(value) for value in across) < 0.6


def test_one_persons_joints_do_not_depend_on_what_the_others_do(frames: list[list[Message]]) -> None:
    others = [PROGRAMMES[0], *[balanced_programme(1, 7)[2:]] * 3]
    pairs = zip(frames[: 40 * 30], frames_of(others), strict=False)
    assert all(one[-1].agents[0] == other[-1].agents[0] for one, other in pairs)


def test_each_persons_actions_have_their_own_truths(frames: list[list[Message]]) -> None:
    truths = [message for messages in frames for message in messages if isinstance(message, Truth)]
    for number, programme in enumerate(PROGRAMMES, start=1):
        own = [truth for truth in truths if truth.agent == number]
        assert [truth.kind for truth in own] == ["start", "end"] * 2
        assert [truth.action for truth in own[::2]] == [task.action for task in programme]
    assert len({truth.segment_id for truth in truths}) == 8


@pytest.mark.parametrize(("asked", "images"), [({}, 0), ({"image_hz": 10}, 10)])
def test_there_are_as_many_images_a_second_as_asked_for_whoever_is_seen(asked: dict[str, int], images: int) -> None:
    second = islice(Group(PROGRAMMES, **asked).frames(), 30)
    assert sum(isinstance(message, Image) for messages in second for message in messages) == images


@pytest.mark.parametrize("count", [0, 5])
def test_nobody_and_more_people_than_fit_are_refused(count: int) -> None:
    with pytest.raises(ValueError, match="cannot show"):
        Group([PROGRAMMES[0]] * count)
