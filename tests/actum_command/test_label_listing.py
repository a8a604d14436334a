"""Segments are listed as training would get them, and named by number or id."""

from functools import partial
from itertools import chain
from pathlib import Path

import pytest

from actum.messages import AUTO, MANUAL, Message, Segment
from actum.recorder import Recorder
from actum.recording import Recording
from actum_model_trainer.sample_reading import samples_from
from command_lines import printed, refused, written
from empty_messages import action
from people import FRAME_NS, reaches
from performers import mark

label, refusal = partial(printed, "label"), partial(refused, "label")
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
    written(tmp_path / "anna.mcap", *reaches(FRAMES), *marks, answered)
    return tmp_path / "anna.mcap"


def rows(path: Path) -> list[str]:
    return [" ".join(line.split()) for line in label(path).splitlines() if line.startswith("  ")]


def marks_of(path: Path, segment_id: str) -> list[tuple[str, int, str | None]]:
    marks = [m for m in Recording(path).messages() if isinstance(m, Segment) and m.segment_id == segment_id]
    return [(m.kind, round(m.stamp_ns / FRAME_NS), m.label) for m in marks]


def of_segment(path: Path, segment_id: str) -> list[Message]:
    return [m for m in Recording(path).messages() if getattr(m, "segment_id", None) == segment_id]


def test_each_action_is_listed_with_whether_it_can_be_used(path: Path) -> None:
    listed = label(path)
    assert listed.startswith(f"{path}, person anna\n")
    assert listed.endswith("4 segments, 1 usable\n")
    assert rows(path) == [
        "1 0.00 s 0.97 s (0.97 s) whole push - nearest usable answered push 1.00",
        "2 1.00 s 1.63 s (0.63 s) unnamed (no label) - nearest not usable: no label",
        "3 1.67 s 1.70 s (0.03 s) short push - nearest not usable: 2 usable frames, at least 3 are needed",
        "4 1.73 s - - open lift - nearest not usable: start without end: the frames ended 0.2 s after the start",
    ]


def test_several_recordings_are_listed_one_after_another(path: Path) -> None:
    path.with_name("bert.mcap").write_bytes(path.read_bytes())
    listed = label(path.parent)
    assert listed.count("4 marked") == 0 and listed.count(", person anna\n") == 2
    assert listed.endswith("8 segments, 2 usable\n")


def test_what_is_listed_as_usable_is_what_training_gets(path: Path) -> None:
    trained = samples_from([Recording(path)])
    assert [sample.segment_id for sample in trained.usable] == ["whole"]
    assert {unusable.segment_id for unusable in trained.unusable} == {"short", "open"}


def test_list_may_be_said_and_takes_the_options_of_the_others(path: Path) -> None:
    assert label("list", path) == label(path) == label("--person", "anna", path)


def test_what_a_classifier_has_found_is_listed_and_becomes_the_users_once_mended(tmp_path: Path) -> None:
    found = [
        mark(kind, frame * FRAME_NS, name).model_copy(update={"origin": AUTO})
        for name, first in (("auto-1", 0), ("auto-2", 30))
        for kind, frame in (("start", first), ("end", first + 20))
    ]
    path = tmp_path / "found.mcap"
    written(path, *reaches(FRAMES), *found)
    assert "not usable: no label" in label(path)
    label("relabel", path, "auto-1", "wave")
    label("move", path, "auto-2", "--start", "+0.1")
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
    assert rows(two_sensors) == [
        f"{number} {span} s (0.63 s) one push - nearest usable answered push 1.00 {sensor}"
        for number, span, sensor in ((1, "0.00 s 0.63", "kinect0"), (2, "0.33 s 0.97", "kinect1"))
    ]


def test_an_action_that_several_sensors_name_alike_is_changed_at_one_of_them_alone(two_sensors: Path) -> None:
    said = refusal("delete", two_sensors, "one")
    assert "2 segments have the id 'one': give the number of the segment (1 or 2) instead of this id" in said
    label("relabel", two_sensors, 2, "pull")
    label("move", two_sensors, 2, "--end", "-0.1")
    of_other = [m for m in of_segment(two_sensors, "one") if m.sensor == "kinect0"]
    assert [getattr(m, "label", None) for m in of_other] == ["push", None, None]
    assert [m.label for m in of_segment(two_sensors, "one") if isinstance(m, Segment)] == ["push", "pull", None, None]
    label("delete", two_sensors, 2)
    assert of_segment(two_sensors, "one") == of_other


def test_a_name_that_is_used_again_after_a_restart_is_several_segments(tmp_path: Path) -> None:
    path = tmp_path / "again.mcap"
    uses = [(first * FRAME_NS, (first + 14) * FRAME_NS) for first in (0, 20, 40)]
    segments = [(mark("start", a, "one", "push"), mark("end", b, "one"), action(a, b, "one")) for a, b in uses]
    written(path, *reaches(FRAMES), *chain(*segments))
    assert "3 segments have the id 'one'" in refusal("delete", path, "one")
    label("delete", path, 2)
    assert marks_of(path, "one") == [("start", 0, "push"), ("end", 14, None), ("start", 40, "push"), ("end", 54, None)]
    assert len(of_segment(path, "one")) == 6
