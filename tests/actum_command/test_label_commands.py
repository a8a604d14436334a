"""The segments of a recording are listed, drawn and mended by their numbers."""

import re
from functools import partial
from pathlib import Path

import pytest

from actum.messages import Message, Segment, Skeleton
from actum.recorder import Recorder
from actum.recording import Recording
from command_lines import invoke, printed, refused, written
from empty_messages import action
from people import FRAME_NS
from performers import mark
from repeating import Stream, five_waves, rest

label, refusal = partial(printed, "label"), partial(refused, "label")
FIRST_NS = 10**9
"""Stamp of the first frame: times count from it, not from the clock's start."""


@pytest.fixture
def waves() -> Stream:
    return five_waves()


@pytest.fixture
def path(tmp_path: Path, waves: Stream) -> Path:
    """Five waves; the first two are marked, the first one answered."""
    at = [(FIRST_NS + a * FRAME_NS, FIRST_NS + b * FRAME_NS) for a, b in waves.truths]
    marks = [
        mark("start", at[1][0], "second"),
        mark("end", at[1][1], "second"),
        mark("start", at[0][0], "first", "wave"),
        mark("end", at[0][1], "first"),
    ]
    written(tmp_path / "anna.mcap", *waves.skeletons(first_ns=FIRST_NS), *marks, action(*at[0], "first"))
    return tmp_path / "anna.mcap"


def rows(path: Path) -> list[str]:
    return [" ".join(line.split()) for line in label(path).splitlines() if line.startswith("  ")]


def unmarked(path: Path) -> list[Message]:
    return [message for message in Recording(path).messages() if not isinstance(message, Segment)]


def marks_of(path: Path, segment_id: str) -> list[Segment]:
    return [m for m in Recording(path).messages() if isinstance(m, Segment) and m.segment_id == segment_id]


def test_segments_are_numbered_in_order_of_time_with_their_answers(path: Path) -> None:
    assert label(path).startswith(f"{path}, person anna\n")
    assert rows(path) == [
        "1 1.20 s 2.57 s (1.37 s) first wave - nearest usable answered push 1.00",
        "2 3.80 s 5.17 s (1.37 s) second (no label) - nearest not usable: no label",
    ]
    assert label("list", path) == label(path)


def test_the_answer_to_a_segment_is_that_of_its_sensor(tmp_path: Path) -> None:
    of_one = [mark("start", 1, "a"), mark("end", 2, "a")]
    of_other = [each.model_copy(update={"sensor": "kinect1"}) for each in (*of_one, action(1, 2, "a"))]
    written(tmp_path / "both.mcap", *of_one, *of_other)
    assert [row.count("answered push 1.00 kinect1") for row in rows(tmp_path / "both.mcap")] == [0, 1]


def test_bounds_are_moved_to_a_time_or_by_a_difference(path: Path) -> None:
    frames = unmarked(path)
    label("move", path, 1, "--start", "1.0", "--end", "+0.2")
    assert rows(path)[0].startswith("1 1.00 s 2.77 s")
    label("move", path, 1, "--end", "-0.2")
    assert rows(path)[0].startswith("1 1.00 s 2.57 s")
    assert unmarked(path) == frames


def test_a_segment_is_relabelled_and_deleted_with_its_answers(path: Path) -> None:
    label("relabel", path, 2, "drink")
    assert [each.label for each in marks_of(path, "second")] == ["drink", None]
    label("delete", path, 1)
    assert rows(path)[0].startswith("1 3.80 s 5.17 s (1.37 s) second drink")
    assert all(getattr(message, "segment_id", None) != "first" for message in Recording(path).messages())


def test_a_segment_is_added_and_deleted_with_its_frames(path: Path) -> None:
    marks = [m for m in Recording(path).messages() if isinstance(m, Segment)]
    label("add", path, 6.4, 7.8, "wave", "--agent", 1)
    assert rows(path)[2] == "3 6.40 s 7.80 s (1.40 s) added-1 wave manual agent 1 usable"
    label("delete", path, 3)
    assert [m for m in Recording(path).messages() if isinstance(m, Segment)] == marks
    empty = [(m.stamp_ns - FIRST_NS) / 1e9 for m in unmarked(path) if isinstance(m, Skeleton) and not m.agents]
    assert (min(empty), max(empty)) == pytest.approx((6.4, 7.8), abs=0.04)


def test_a_segment_without_a_label_is_deleted_without_its_frames(path: Path) -> None:
    frames = unmarked(path)
    label("delete", path, 2)
    assert unmarked(path) == frames and len(rows(path)) == 1


def test_repetitions_are_cut_and_cut_anew(tmp_path: Path, waves: Stream) -> None:
    path = tmp_path / "unmarked.mcap"
    written(path, *waves.skeletons(first_ns=FIRST_NS))
    frames = unmarked(path)
    assert "5 segments labelled 'wave'" in label("cut", path, 5, "wave")
    starts = [float(row.split()[1]) for row in rows(path)]
    assert starts == pytest.approx([first * FRAME_NS / 1e9 for first, _ in waves.truths], abs=0.4)
    assert all(" wave cut agent 1" in row for row in rows(path))
    label("relabel", path, 2, "other")
    label("cut", path, 5, "greet")
    assert len(rows(path)) == 5
    assert all(" greet cut agent 1" in row for row in rows(path))
    assert unmarked(path) == frames


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_the_stream_is_drawn_with_and_without_answers(path: Path, tmp_path: Path, ending: str) -> None:
    assert "2 segments drawn" in label("picture", path, "-o", tmp_path / f"stream.{ending}")
    assert (tmp_path / f"stream.{ending}").stat().st_size > 1000


def test_an_empty_label_is_none(path: Path, waves: Stream, tmp_path: Path) -> None:
    nameless = tmp_path / "nameless.mcap"
    with Recorder(nameless, person="", source="test") as recorder:
        answer = action(*(FIRST_NS + frame * FRAME_NS for frame in waves.truths[0]), "one")
        for message in [*Recording(path).messages(), answer.model_copy(update={"action": ""})]:
            recorder.write(message.model_copy(update={"label": ""}) if isinstance(message, Segment) else message)
    assert [row.count("(no label)") for row in rows(nameless)] == [1, 1]
    assert "2 segments drawn" in label("picture", nameless, "-o", tmp_path / "stream.png")


def test_a_recording_without_marks_is_listed_drawn_and_added_to(tmp_path: Path) -> None:
    path = tmp_path / "bare.mcap"
    written(path, *Stream().then(rest(2)).skeletons(), person="")
    assert label(path).endswith("0 segments, 0 usable\n")
    assert "0 segments drawn" in label("picture", path, "-o", tmp_path / "bare.png")
    assert "shows no person who moves" in refusal("cut", path, 5, "wave")
    label("add", path, 0.5, 1.5, "stand")
    assert rows(path) == ["1 0.50 s 1.50 s (1.00 s) added-1 stand manual nearest usable"]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("delete", 3), "there is no segment '3' in .*anna.mcap: the recording has segments 1 to 2"),
        (("move", 0, "--start", "1"), "there is no segment '0'"),
        (
            ("move", 1, "--start", "2", "--end", "1.5"),
            "extend from 2.00 to 1.50 s, which is too short: set the end at least",
        ),
        (("move", 1, "--end", "+3"), r"1.20 to 5.57 s and overlap the segment second \(3.80 to 5.17 s\)"),
        (("move", 1, "--start", "-9"), "but the recording has frames only from 0 to"),
        (("move", 1, "--end", "3600"), "but the recording has frames only from 0 to"),
        (("delete", "frst"), "no segment 'frst' in .*anna.mcap: did you mean first"),
        (("move", 1, "--start", "soon"), "'soon' is not a time"),
        (("move", 1, "--start", "nan"), "'nan' is not a time"),
        (("add", 2.0, 3.0, "wave"), "overlap the segment first"),
        (("relabel", 1, ""), "the label has 0 characters: use 1 to 200 characters"),
        (("cut", 5, "wave"), "overlap the segment first"),
    ],
)
def test_what_cannot_be_done_is_refused_and_changes_nothing(
    arguments: tuple[str, ...], reason: str, path: Path
) -> None:
    before = path.read_bytes()
    command, *others = arguments
    assert re.search(reason, refusal(command, path, *others))
    assert path.read_bytes() == before


def test_what_is_no_recording_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_text("nothing")
    assert "the file is not an MCAP file" in refusal(tmp_path / "a.mcap")


def test_a_picture_of_another_kind_is_refused(path: Path, tmp_path: Path) -> None:
    assert "does not end in .png or .svg" in refusal("picture", path, "-o", tmp_path / "a.gif")
    assert "does not exist" in refusal("picture", path, "-o", tmp_path / "a.png", "--model", tmp_path / "m.npz").lower()


@pytest.mark.parametrize("seconds", ["1e300", "-1e300"])
def test_a_time_beyond_any_clock_is_refused(path: Path, seconds: str) -> None:
    before = path.read_bytes()
    for command in (
        ["label", "add", str(path), "--", "0", seconds, "wave"],
        ["label", "add", str(path), "--", seconds, "1", "wave"],
        ["label", "move", str(path), "1", f"--start={seconds}"],
        ["label", "move", str(path), "first", f"--end={seconds}"],
    ):
        ended = invoke(*command)
        assert (ended.exit_code, ended.stderr.count("\n")) == (1, 1), command
    assert path.read_bytes() == before
