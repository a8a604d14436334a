"""To delete an example means one thing, whoever is asked for it; what was mirrored stays whole in every command."""

import shutil
from itertools import chain
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Agent, Intent, Skeleton, segment_marks
from actum.recording import Recording
from actum_examples.stored_changes import mirror_image
from actum_examples.take import MIRRORED
from actum_model_trainer.sample_reading import samples_from
from command_lines import printed, refused, written
from empty_messages import contact, intent
from people import FRAME_NS, reaching, skeleton
from teaching import Teacher

FIRST_NS, FRAMES = 10**9, 90


def bodies() -> list[Skeleton]:
    poses = (reaching((index % 30 + 1) / 31) for index in range(FRAMES))
    return [skeleton(FIRST_NS + i * FRAME_NS, pose, pose + 1, seq=i) for i, pose in enumerate(poses)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Two people; the first one's two examples overlap, so that frames 20 to 30 belong to both."""
    path = tmp_path / "take-0001.mcap"
    examples = (("one", 5, 30, "wave"), ("two", 20, 50, "nod"), ("three", 60, 80, "wave"))
    marks = [
        segment_marks(FIRST_NS + first * FRAME_NS, FIRST_NS + last * FRAME_NS, "kinect0", name, label, 1)
        for name, first, last, label in examples
    ]
    return written(path, *bodies(), *chain(*marks))


def by_trainer(path: Path, command: str, segment_id: str, **fields: int) -> None:
    teacher = Teacher(path.parent / "trainer")
    teacher.ask("create_set", set="kitchen")
    there = teacher.folder / "sets/kitchen" / path.name
    shutil.copy(path, there)
    teacher.ask(command, set="kitchen", example=f"{path.stem}/{segment_id}", **fields)
    shutil.move(there, path)


def people(path: Path) -> list[list[Agent]]:
    return [each.agents for each in Recording(path).messages((keys.SKELETON,)) if isinstance(each, Skeleton)]


@pytest.mark.parametrize("how", ["trainer", "label"])
def test_a_deleted_example_takes_along_the_frames_that_no_other_needs(path: Path, how: str) -> None:
    if how == "trainer":
        by_trainer(path, "delete", "one")
    else:
        printed("label", "delete", path, "one")
    seen = [[agent.agent for agent in agents] for agents in people(path)]
    assert seen == [[2] if 5 <= frame < 20 else [1, 2] for frame in range(FRAMES)]
    (stream,) = [each for each in samples_from([Recording(path)]).streams if each.agent == 1]
    frames = {(int(stamp_ns) - FIRST_NS) // FRAME_NS for stamp_ns in stream.stamps_ns}
    assert not frames & set(range(5, 20)), "nothing of it is learnt as background"


def test_a_deleted_example_takes_along_the_intents_that_name_it(tmp_path: Path) -> None:
    named = [intent(FIRST_NS + i, contact(0.9), segment_id=name) for i, name in enumerate(("one", "two", None))]
    marks = [segment_marks(FIRST_NS, FIRST_NS + FRAME_NS, "kinect0", name, "wave", 1) for name in ("one", "two")]
    path = written(tmp_path / "take-0001.mcap", *bodies(), *named, *chain(*marks))
    printed("label", "delete", path, "one")
    left = [each.segment_id for each in Recording(path).messages((keys.INTENT,)) if isinstance(each, Intent)]
    assert left == ["two", None]


def mirrored_frames(path: Path) -> set[int]:
    plain = [body.agents[0] for body in bodies()]
    stored = [next(each for each in agents if each.agent == 1) for agents in people(path)]
    for there, true in zip(stored, plain, strict=True):
        assert there.joints in (
            [pytest.approx(j) for j in true.joints],
            [pytest.approx(j) for j in mirror_image(true).joints],
        )
    return {
        number
        for number, (there, true) in enumerate(zip(stored, plain, strict=True))
        if there.joints != [pytest.approx(joint) for joint in true.joints]
    }


def test_the_frames_follow_a_mirrored_segment_that_is_moved(path: Path) -> None:
    by_trainer(path, "mirror", "three")
    assert mirrored_frames(path) == set(range(60, 81))
    later_s = 5 * FRAME_NS / 1e9
    printed("label", "move", path, 3, "--start", f"+{later_s}", "--end", f"+{later_s}")
    assert mirrored_frames(path) == set(range(65, 86))


def test_a_mirrored_segment_does_not_reach_into_a_plain_one(path: Path) -> None:
    by_trainer(path, "mirror", "three")
    assert "segment three is mirrored" in refused("label", "move", path, "three", "--start", f"-{10 * FRAME_NS / 1e9}")


def test_nothing_is_mirrored_once_its_segment_is_deleted(path: Path) -> None:
    by_trainer(path, "mirror", "three")
    printed("label", "delete", path, "three")
    assert Recording(path).metadata[MIRRORED] == "[]"
