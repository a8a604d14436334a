"""Whose answers stand in the picture of a recording: the recorded ones or a model's, and what a model finds."""

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from actum.recording import Recording
from actum_command.recording_picture import write_picture
from actum_examples.take import read_take
from command_lines import written
from empty_messages import action
from handmade import pyramid_model
from people import FRAME_NS
from performers import mark
from repeating import five_waves
from som_classifier.model import Model
from som_classifier.spotting.spotted import SpottedSegment
from spotters import finding

FOUND = SpottedSegment(150 * FRAME_NS, 190 * FRAME_NS, "sit")
SEARCHING = finding(pyramid_model(), FOUND)


@pytest.mark.parametrize(
    ("model", "lanes"), [(None, ["answer"]), (pyramid_model(), ["answer"]), (SEARCHING, ["answer", "found"])]
)
def test_a_model_that_searches_has_a_lane_of_what_it_finds(
    model: Model | None, lanes: Sequence[str], tmp_path: Path
) -> None:
    waves = five_waves()
    start_ns, end_ns = (frame * FRAME_NS for frame in waves.truths[0])
    marks = mark("start", start_ns, "first", "wave"), mark("end", end_ns, "first")
    written(tmp_path / "waves.mcap", *waves.skeletons(), *marks, action(start_ns, end_ns, "first"))
    write_picture(read_take(Recording(tmp_path / "waves.mcap")), model, tmp_path / "waves.svg")
    drawn = re.findall(r">([^<>]+)</text>", (tmp_path / "waves.svg").read_text())
    assert [text for text in drawn if text in ("answer", "found")] == lanes
