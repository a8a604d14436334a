"""How rightly the posture of people is told, of whom none was looked at when its limits were chosen.

In UTKinect people walk, lift, carry, throw, push, pull, wave and clap standing, and sit at the end of *sitDown* and the
beginning of *standUp*. No one lies there or crouches for certain.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator

from benchmarks.originals import ImportedSets

from actum import keys
from actum.arrays import joints_to_array
from actum.messages import Segment, Skeleton
from actum.recording import Recording
from actum_dataset_importer.importing import import_utkinect
from ros2_bridge.hri_out.posture import posture_of

PEOPLE = frozenset(map(str, range(6, 11)))
"""UTKinect's people; the limits were chosen with the others."""
SEATED_FRAMES = 3
"""How many of the last frames of *sitDown*, and of the first of *standUp*, count as seated."""
POSTURES = ("OTHER", "STANDING", "SITTING", "CROUCHING", "LAYING")
"""The constants of hri_msgs/BodyPosture, by their numbers."""
PICKING_UP = "pickUp"
"""In it people bend and squat: none of the postures is right all the time."""
SEATED = {"sitDown": slice(-SEATED_FRAMES, None), "standUp": slice(0, SEATED_FRAMES)}
"""The frames of each action in which the person is seated for certain."""


def of_postures(data: ImportedSets) -> Iterator[str]:
    """Yield a line for those who sit, who pick something up, and who do anything else, with the postures told."""
    told: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for recording in data.recordings("utkinect", import_utkinect):
        if recording.person in PEOPLE:
            for label, posture in _told(recording):
                told[label].update([POSTURES[posture]])
    for label, counts in sorted(told.items()):
        yield f"{label}: {', '.join(f'{count} {posture}' for posture, count in counts.most_common())}"


def _told(recording: Recording) -> Iterator[tuple[str, int]]:
    """Yield what somebody does in each frame of a labelled segment, and the posture that is told."""
    skeletons = [each for each in recording.messages([keys.SKELETON]) if isinstance(each, Skeleton)]
    starts: dict[str, Segment] = {}
    for mark in recording.messages([keys.SEGMENT]):
        assert isinstance(mark, Segment)
        start = starts.setdefault(mark.segment_id, mark)
        if mark.kind == "start":
            continue
        label = start.label or mark.label or ""
        frames = [each for each in skeletons if (start.stamp_ns or 0) <= each.stamp_ns <= (mark.stamp_ns or 0)]
        doing = "seated" if label in SEATED else label if label == PICKING_UP else "standing"
        for frame in frames[SEATED.get(label, slice(None))]:
            for agent in frame.agents:
                yield doing, posture_of(joints_to_array(agent.joints), frame.up_in_camera)
