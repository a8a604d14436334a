"""What a take holds: its marked segments, and which of them are examples."""

from pathlib import Path

import pytest

from actum.messages import Segment
from actum.recorder import Recorder
from actum.recording import Recording
from actum_examples.take import read_take
from people import FRAME_NS, STANDING, skeleton


@pytest.mark.parametrize(
    ("label", "kinds", "labels"),
    [("wave", ("start", "end"), ["wave"]), (None, ("start", "end"), []), ("wave", ("start",), [])],
    ids=["whole", "without a label", "without an end"],
)
def test_an_example_has_a_label_and_both_bounds(
    tmp_path: Path, label: str | None, kinds: tuple[str, ...], labels: list[str]
) -> None:
    with Recorder(tmp_path / "take.mcap", person="anna", source="test") as recorder:
        for index in range(10):
            recorder.write(skeleton(index * FRAME_NS, STANDING))
        for kind in kinds:
            stamp_ns = FRAME_NS if kind == "start" else 8 * FRAME_NS
            recorder.write(Segment(stamp_ns=stamp_ns, sensor="kinect0", kind=kind, segment_id="a", label=label))
    take = read_take(Recording(tmp_path / "take.mcap"))
    assert len(take.segments) == 1
    assert take.labels == labels
    assert len(take.examples) == len(labels)
