"""Examples stay whole after any sequence of edits: mirrored throughout or not at all, and deleted with their frames."""

import contextlib
import shutil
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum import keys
from actum.commands import Refusal
from actum.messages import Segment, Skeleton, segment_marks
from actum.recorder import Recorder
from actum.recording import Recording
from actum_examples.stored_changes import mirror_image
from people import FRAME_NS, STANDING, reaching, skeleton
from teaching import Teacher

FRAMES = 40
FIRST_NS = 10**9
PEOPLE = (1, 2)


def stamp_of(frame: int) -> int:
    return FIRST_NS + frame * FRAME_NS


def bodies() -> list[Skeleton]:
    """Two people who reach with the right hand, so that a mirrored body is another one."""
    poses = (reaching(index / FRAMES) for index in range(FRAMES))
    return [skeleton(stamp_of(index), pose, pose + 0.5, seq=index) for index, pose in enumerate(poses)]


@dataclass
class Believed:
    """An example as it is to be."""

    agent: int | None
    first: int
    last: int
    mirrored: bool = False

    def holds(self, frame: int, agent: int) -> bool:
        return self.first <= frame <= self.last and self.agent in (None, agent)

    def shares(self, other: "Believed") -> bool:
        return any(self.holds(f, a) and other.holds(f, a) for f in range(FRAMES) for a in PEOPLE)


@dataclass
class Model:
    """What a take holds after some edits."""

    examples: dict[str, Believed]
    gone: set[tuple[int, int]] = field(default_factory=set)

    def mirror(self, name: str) -> None:
        together, found = {name}, True
        while found:
            found = [
                other
                for other, each in self.examples.items()
                if other not in together and any(each.shares(self.examples[one]) for one in together)
            ]
            together |= set(found)
        mirrored = not self.examples[name].mirrored
        for each in together:
            self.examples[each].mirrored = mirrored

    def delete(self, name: str) -> None:
        example = self.examples.pop(name)
        for frame in range(FRAMES):
            for agent in PEOPLE:
                if example.holds(frame, agent) and not any(each.holds(frame, agent) for each in self.examples.values()):
                    self.gone.add((frame, agent))


def written(folder: Path, spans: list[tuple[int | None, int, int]]) -> Path:
    path = folder / "sets/kitchen/take-0001.mcap"
    with Recorder(path, person="anna", source="test") as recorder:
        for each in bodies():
            recorder.write(each)
        for number, (agent, first, last) in enumerate(spans):
            for mark in segment_marks(
                stamp_of(first), stamp_of(last), "kinect0", f"e{number}", "wave", agent, "left", "manual"
            ):
                recorder.write(mark)
    return path


def check(path: Path, teacher: Teacher, model: Model) -> None:
    listed = {each["id"].partition("/")[2]: each for each in teacher.examples()}
    assert {
        name: Believed(
            each["agent"],
            (each["start_ns"] - FIRST_NS) // FRAME_NS,
            (each["end_ns"] - FIRST_NS) // FRAME_NS,
            each["mirrored"],
        )
        for name, each in listed.items()
    } == model.examples
    for message, plain in zip(Recording(path).messages((keys.SKELETON,)), bodies(), strict=True):
        assert isinstance(message, Skeleton)
        frame = (message.stamp_ns - FIRST_NS) // FRAME_NS
        stored = {each.agent: each for each in message.agents}
        for agent in plain.agents:
            if (frame, agent.agent) in model.gone:
                assert agent.agent not in stored
                continue
            mirrored = [each.mirrored for each in model.examples.values() if each.holds(frame, agent.agent)]
            assert len(set(mirrored)) <= 1, "an example would be mirrored in part"
            wanted = mirror_image(agent) if any(mirrored) else agent
            for joint, true in zip(stored[agent.agent].joints, wanted.joints, strict=True):
                assert joint == pytest.approx(true, abs=1e-9)


Spans = st.lists(
    st.tuples(st.sampled_from([None, 1, 2]), st.integers(0, FRAMES - 5), st.integers(4, 12)).map(
        lambda each: (each[0], each[1], min(each[1] + each[2], FRAMES - 1))
    ),
    min_size=1,
    max_size=4,
)
Edits = st.lists(
    st.tuples(
        st.sampled_from(["mirror", "mirror", "trim", "trim", "relabel", "delete", "begin"]),
        st.integers(0, 3),
        st.integers(0, FRAMES - 5),
        st.integers(4, 14),
    ),
    max_size=8,
)
numbers = count()


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(spans=Spans, edits=Edits)
def test_an_example_is_whole_after_any_sequence_of_edits(
    tmp_path: Path, spans: list[tuple[int | None, int, int]], edits: list[tuple[str, int, int, int]]
) -> None:
    folder = tmp_path / str(next(numbers))
    teacher = Teacher(folder)
    teacher.ask("create_set", set="kitchen")
    path = written(folder, spans)
    model = Model({f"e{number}": Believed(*span) for number, span in enumerate(spans)})
    for edit, number, first, frames in edits:
        name, last = f"e{number}", min(first + frames, FRAMES - 1)
        if edit == "begin":
            teacher.begin()
        elif name in model.examples:
            fields: dict[str, Any] = {"set": "kitchen", "example": f"take-0001/{name}"}
            if edit == "trim":
                with contextlib.suppress(Refusal):
                    teacher.ask("trim", **fields, start_ns=stamp_of(first), end_ns=stamp_of(last))
                    model.examples[name].first, model.examples[name].last = first, last
            elif edit == "relabel":
                teacher.ask("relabel", **fields, label="nod")
            else:
                teacher.ask(edit, **fields)
                (model.mirror if edit == "mirror" else model.delete)(name)
        check(path, teacher, model)
    shutil.rmtree(folder)


def one_take(folder: Path, *spans: tuple[int | None, int, int]) -> tuple[Teacher, Path]:
    teacher = Teacher(folder)
    teacher.ask("create_set", set="kitchen")
    return teacher, written(folder, list(spans))


def test_a_mirrored_example_that_is_trimmed_is_mirrored_in_its_new_bounds(tmp_path: Path) -> None:
    teacher, path = one_take(tmp_path, (1, 10, 20))
    teacher.ask("mirror", set="kitchen", example="take-0001/e0")
    teacher.ask("trim", set="kitchen", example="take-0001/e0", start_ns=stamp_of(5), end_ns=stamp_of(15))
    check(path, teacher, Model({"e0": Believed(1, 5, 15, mirrored=True)}))


def test_a_mirrored_example_keeps_apart_from_plain_ones(tmp_path: Path) -> None:
    teacher, _ = one_take(tmp_path, (1, 5, 10), (1, 20, 30))
    teacher.ask("mirror", set="kitchen", example="take-0001/e0")
    with pytest.raises(Refusal, match="segment e0 is mirrored .* and segment e1 is not"):
        teacher.ask("trim", set="kitchen", example="take-0001/e0", start_ns=stamp_of(5), end_ns=stamp_of(20))


def test_the_hand_that_a_mark_names_survives_edits_and_is_exchanged_in_the_mirror(tmp_path: Path) -> None:
    teacher, path = one_take(tmp_path, (1, 10, 20))

    def hands() -> set[str | None]:
        return {each.hand for each in Recording(path).messages((keys.SEGMENT,)) if isinstance(each, Segment)}

    teacher.ask("relabel", set="kitchen", example="take-0001/e0", label="nod")
    assert hands() == {"left"}
    teacher.ask("mirror", set="kitchen", example="take-0001/e0")
    assert hands() == {"right"}


def test_frames_that_another_example_of_that_person_needs_stay(tmp_path: Path) -> None:
    teacher, path = one_take(tmp_path, (1, 5, 20), (1, 15, 30), (2, 5, 30))
    teacher.ask("delete", set="kitchen", example="take-0001/e0")
    for message in Recording(path).messages((keys.SKELETON,)):
        assert isinstance(message, Skeleton)
        frame = (message.stamp_ns - FIRST_NS) // FRAME_NS
        assert [each.agent for each in message.agents] == ([2] if 5 <= frame < 15 else [1, 2]), frame


def test_the_last_example_of_a_recording_from_elsewhere_leaves_the_rest_of_it(tmp_path: Path) -> None:
    teacher, path = one_take(tmp_path, (1, 5, 20))
    teacher.ask("delete", set="kitchen", example="take-0001/e0")
    assert path.exists() and teacher.examples() == []
    assert sum(len(each.agents) for each in Recording(path).messages((keys.SKELETON,))) == 2 * FRAMES - 16


def test_a_standing_body_is_its_own_mirror_image_twice() -> None:
    (agent,) = skeleton(0, STANDING).agents
    assert mirror_image(mirror_image(agent)).joints == [pytest.approx(joint, abs=1e-12) for joint in agent.joints]
