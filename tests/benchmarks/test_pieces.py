from pathlib import Path

import pytest
from benchmarks.recognition.videos import PIECE_NS, Pieces

from actum.messages import Agent, Segment, Skeleton
from actum.recorder import Recorder

pytestmark = pytest.mark.thorough

FRAMES = 7
EVERY_NS = PIECE_NS // 3
"""Three frames a piece: two whole pieces, and one frame that is left."""


def test_a_recording_is_cut_into_whole_pieces(tmp_path: Path) -> None:
    joints = [[0.1 * i, 0.2 * i, 2.0] for i in range(15)]
    with Recorder(tmp_path / "swing.mcap", person="1", source="test") as recorder:
        for i in range(FRAMES):
            agent = Agent(agent=1, joints=joints, confidence=[1.0] * 15)
            recorder.write(Skeleton(stamp_ns=i * EVERY_NS, sensor="camera0", agents=[agent]))
        recorder.write(Segment(stamp_ns=0, sensor="camera0", kind="start", segment_id="all", label="swing"))
        recorder.write(Segment(stamp_ns=PIECE_NS * 2, sensor="camera0", kind="end", segment_id="all"))
    told = [
        (message.kind, message.segment_id) if isinstance(message, Segment) else message.stamp_ns // EVERY_NS
        for message in Pieces(tmp_path / "swing.mcap").messages()
    ]
    first = [("start", "swing-00"), 0, 1, 2, ("end", "swing-00")]
    second = [("start", "swing-01"), 3, 4, 5, ("end", "swing-01")]
    assert told == [*first, *second, 6]
