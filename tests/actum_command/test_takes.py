"""The marked actions of recordings are listed as training would get them, and mended one by one."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from actum.messages import AUTO, MANUAL, Message, Segment, Skeleton
from actum.recorder import Recorder
from actum.recording import Recording
from actum_command.__main__ import app
from actum_model_trainer.samples import samples_from
from empty_messages import action
from people import FRAME_NS, reaches
from performers import mark

FRAMES = 60


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Two seconds of one person: an action that can be used, one without a label, a short one, one without an end."""
    marks = [
        mark("start", 0, "whole", "push"),
        mark("end", 29 * FRAME_NS, "whole"),
        mark("start", 30 * FRAME_NS, "unnamed"),
        mark("end", 49 * FRAME_NS, "unnamed"),
        mark("start", 50 * FRAME_NS, "short", "push"),
        mark("end", 51 * FRAME_NS, "short"),
        mark("start", 52 * FRAME_NS, "open", "lift"),
    ]
    answered = action(0, 29 * FRAME_NS, "whole")
    with Recorder(tmp_path / "anna.mcap", person="anna", source="test") as recorder:
        for message in [*reaches(FRAMES), *marks, answered]:
            recorder.write(message)
    return tmp_path / "anna.mcap"


def takes(*arguments: object) -> str:
    done = CliRunner().invoke(app, ["takes", *map(str, arguments)])
    assert done.exit_code == 0, done.output
    return done.stdout


def refused(*arguments: object) -> str:
    ended = CliRunner().invoke(app, ["takes", *map(str, arguments)])
    assert ended.exit_code == 1, ended.output
    assert ended.stderr.count("\n") == 1
    return ended.stderr


def rows(path: Path) -> dict[str, str]:
    """Each listed action's line by its segment."""
    listed = [line.split() for line in takes(path).splitlines() if line.startswith("  ")]
    return {words[0]: " ".join(words[1:]) for words in listed}


def marks_of(path: Path, segment_id: str) -> list[tuple[str, int, str | None]]:
    marks = [m for m in Recording(path).messages() if isinstance(m, Segment) and m.segment_id == segment_id]
    return [(m.kind, round(m.stamp_ns / FRAME_NS), m.label) for m in marks]


def of_segment(path: Path, segment_id: str) -> list[Message]:
    return [m for m in Recording(path).messages() if getattr(m, "segment_id", None) == segment_id]


def test_each_action_is_listed_with_whether_it_can_be_used(path: Path) -> None:
    listed = takes(path)
    assert listed.startswith(f"{path}, person anna\n")
    assert listed.endswith("4 marked actions, 1 usable\n")
    assert rows(path)["whole"] == "push 0.97 s 30 frames usable"
    assert rows(path)["unnamed"] == "(no label) 0.63 s 20 frames not usable: no label"
    assert rows(path)["short"] == "push 0.03 s 2 frames not usable: 2 usable frames, at least 3 are needed"
    assert "not usable: start without end" in rows(path)["open"]


def test_what_is_listed_as_usable_is_what_training_gets(path: Path) -> None:
    trained = samples_from([Recording(path)])
    assert [sample.segment_id for sample in trained.usable] == ["whole"]
    assert {unusable.segment_id for unusable in trained.unusable} == {"short", "open"}


def test_list_may_be_said_and_takes_the_options_of_the_others(path: Path) -> None:
    assert takes("list", path) == takes(path) == takes("--person", "anna", path)


def test_a_label_is_given_anew(path: Path) -> None:
    takes("relabel", path, "unnamed", "pull")
    assert marks_of(path, "unnamed") == [("start", 30, "pull"), ("end", 49, None)]
    assert rows(path)["unnamed"] == "pull 0.63 s 20 frames usable"
    assert marks_of(path, "whole") == [("start", 0, "push"), ("end", 29, None)]


def test_start_and_end_are_moved(path: Path) -> None:
    takes("trim", path, "unnamed", "--start", 5 * FRAME_NS / 1e9, "--end", 10 * FRAME_NS / 1e9)
    assert marks_of(path, "unnamed") == [("start", 35, None), ("end", 40, None)]
    takes("trim", path, "unnamed", "--start", -5 * FRAME_NS / 1e9)
    assert marks_of(path, "unnamed") == [("start", 30, None), ("end", 40, None)]


def test_an_action_is_dropped_with_its_answers_and_the_person_in_its_frames(path: Path) -> None:
    takes("drop", path, "whole")
    assert of_segment(path, "whole") == []
    skeletons = [m for m in Recording(path).messages() if isinstance(m, Skeleton)]
    assert len(skeletons) == FRAMES
    assert [bool(each.agents) for each in skeletons] == [False] * 30 + [True] * (FRAMES - 30)
    assert set(rows(path)) == {"unnamed", "short", "open"}


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("drop", "wole"), "no 'wole' in .*anna.mcap: is whole meant"),
        (("relabel", "whole", ""), "the label must have 1 to 200 characters"),
        (("trim", "whole", "--start", "2"), "would run from 2 s to 0.96"),
        (("trim", "whole", "--start", "-2"), "before time 0 of the sensor's clock"),
        (("trim", "whole", "--end", "3600"), "3600.00 s lies outside the recording's frames"),
        (("trim", "open", "--end", "2"), "open has no end mark"),
    ],
)
def test_what_cannot_be_done_is_refused_and_changes_nothing(
    arguments: tuple[str, ...], reason: str, path: Path
) -> None:
    before = path.read_bytes()
    command, *rest = arguments
    assert re.search(reason, refused(command, path, *rest))
    assert path.read_bytes() == before


def test_a_recording_without_marks_says_so(tmp_path: Path) -> None:
    with Recorder(tmp_path / "bare.mcap", person="", source="test") as recorder:
        for frame in reaches(3):
            recorder.write(frame)
    assert (
        takes(tmp_path)
        == f"{tmp_path / 'bare.mcap'}, person (unknown)\n  no marked action\n0 marked actions, 0 usable\n"
    )
    assert "nothing is marked" in refused("drop", tmp_path / "bare.mcap", "a")


def test_what_a_classifier_has_found_is_listed_and_becomes_the_users_once_mended(tmp_path: Path) -> None:
    found = [
        mark(kind, frame * FRAME_NS, name).model_copy(update={"origin": AUTO})
        for name, first in (("auto-1", 0), ("auto-2", 30))
        for kind, frame in (("start", first), ("end", first + 20))
    ]
    path = tmp_path / "found.mcap"
    with Recorder(path, person="anna", source="test") as recorder:
        for message in [*reaches(FRAMES), *found]:
            recorder.write(message)
    assert "not usable: no label" in takes(path)
    takes("relabel", path, "auto-1", "wave")
    takes("trim", path, "auto-2", "--start", "0.1")
    assert {m.origin for m in Recording(path).messages() if isinstance(m, Segment)} == {MANUAL}
    (sample,) = samples_from([Recording(path)]).usable
    assert (sample.segment_id, sample.label) == ("auto-1", "wave")


@pytest.fixture
def two_sensors(tmp_path: Path) -> Path:
    """Two sensors that see one person; each has a segment "one", at different times, and an answer to it."""
    path = tmp_path / "two.mcap"
    with Recorder(path, person="anna", source="test") as recorder:
        for sensor, first in (("kinect0", 0), ("kinect1", 10)):
            at = first * FRAME_NS, (first + 19) * FRAME_NS
            own = [mark("start", at[0], "one", "push"), mark("end", at[1], "one"), action(*at, "one")]
            for message in [*reaches(FRAMES), *own]:
                recorder.write(message.model_copy(update={"sensor": sensor}))
    return path


def test_actions_of_several_sensors_are_listed_with_their_sensor(two_sensors: Path) -> None:
    lines = [" ".join(line.split()) for line in takes(two_sensors).splitlines() if line.startswith("  ")]
    assert lines == [f"one push 0.63 s 20 frames usable, {sensor}" for sensor in ("kinect0", "kinect1")]


def test_an_action_that_several_sensors_name_alike_is_changed_at_one_of_them_alone(two_sensors: Path) -> None:
    told = refused("drop", two_sensors, "one")
    assert "2 segments are named 'one'" in told
    assert "kinect0 from 0.00 to 0.63 s, kinect1 from 0.33 to 0.97 s): name one with --sensor" in told
    takes("relabel", two_sensors, "one", "pull", "--sensor", "kinect1")
    takes("trim", two_sensors, "one", "--end", "0.5", "--sensor", "kinect1")
    of_other = [m for m in of_segment(two_sensors, "one") if m.sensor == "kinect0"]
    assert [getattr(m, "label", None) for m in of_other] == ["push", None, None]
    assert [m.label for m in of_segment(two_sensors, "one") if isinstance(m, Segment)] == ["push", "pull", None, None]
    takes("drop", two_sensors, "one", "--sensor", "kinect1")
    assert of_segment(two_sensors, "one") == of_other
    assert "no 'one' of kinect1 in" in refused("drop", two_sensors, "one", "--sensor", "kinect1")


def test_a_name_that_is_used_again_after_a_restart_is_several_segments(tmp_path: Path) -> None:
    path = tmp_path / "again.mcap"
    uses = [(0, 14), (20, 34), (40, 54)]
    with Recorder(path, person="anna", source="test") as recorder:
        for message in reaches(FRAMES):
            recorder.write(message)
        for first, last in uses:
            at = first * FRAME_NS, last * FRAME_NS
            for message in (mark("start", at[0], "one", "push"), mark("end", at[1], "one"), action(*at, "one")):
                recorder.write(message)
    assert "3 segments are named 'one'" in refused("drop", path, "one")
    assert "use 'actum label', which numbers" in refused("drop", path, "one")
    invoked = CliRunner().invoke(app, ["label", "delete", str(path), "2"])
    assert invoked.exit_code == 0, invoked.output
    assert marks_of(path, "one") == [("start", 0, "push"), ("end", 14, None), ("start", 40, "push"), ("end", 54, None)]
    assert len(of_segment(path, "one")) == 6
