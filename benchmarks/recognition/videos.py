"""The sets that are videos: seen by the pose model that ACTUM_POSE_MODEL names, as the camera source does."""

import os
from collections.abc import Collection, Iterator, Sequence
from functools import partial
from importlib import import_module
from itertools import groupby
from pathlib import Path

from actum import keys
from actum.messages import Message, Segment, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_dataset_importer.clips import Naming
from actum_dataset_importer.importing import ImportReport, Progress, import_video
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.settings import Settings

FLORENCE_NAMING = Naming.of(
    r".*actor(?P<person>\d+)idAction\d+category(?P<action>\d+)",
    "1=wave,2=drink,3=answer phone,4=clap,5=tight lace,6=sit down,7=stand up,8=read watch,9=bow",
)

EXERCISE_NAMING = Naming.of(r"(?P<action>exercise)", "")
PIECE_NS = 3 * SECOND_NS
"""How long the pieces are that the video of exercises is cut into."""


def why_no_camera() -> str | None:
    """Say why the video sets cannot be seen here; None where they can."""
    if not Path(os.environ.get("ACTUM_POSE_MODEL") or "/").is_file():
        return "ACTUM_POSE_MODEL names no pose model"
    try:
        import_module("mediapipe")
    except (ImportError, OSError) as error:
        return f"MediaPipe cannot be imported ({error})"
    return None


def import_florence(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Import the clips as `actum import video` does; they are mirror images, as the writing on a shirt shows."""
    settings = Settings(people=1, mirrored=True)
    opened = partial(estimator_of, settings)
    return import_video(src, out, progress, naming=FLORENCE_NAMING, optics=optics_of(settings), opened=opened)


def import_exercise(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Import the video of exercises in the same way."""
    settings = Settings(people=1)
    opened = partial(estimator_of, settings)
    return import_video(src, out, progress, naming=EXERCISE_NAMING, optics=optics_of(settings), opened=opened)


class Pieces(Recording):
    """A recording of one sensor cut into segments of equal length; what remains at its end is in none."""

    def messages(self, topics: Collection[keys.Topic] | None = None) -> Iterator[Message]:
        """Yield its skeletons, and marks of the pieces instead of its own, whatever is asked for."""
        skeletons = [message for message in super().messages((keys.SKELETON,)) if isinstance(message, Skeleton)]
        first_ns, last_ns = skeletons[0].stamp_ns, skeletons[-1].stamp_ns
        for number, group in groupby(skeletons, lambda skeleton: (skeleton.stamp_ns - first_ns) // PIECE_NS):
            piece, is_whole = list(group), first_ns + (number + 1) * PIECE_NS <= last_ns
            yield from _marked(piece, f"{self.path.stem}-{number:02d}") if is_whole else piece


def _marked(frames: Sequence[Skeleton], name: str) -> Iterator[Message]:
    sensor = frames[0].sensor
    yield Segment(stamp_ns=frames[0].stamp_ns, sensor=sensor, kind="start", segment_id=name, label="exercise")
    yield from frames
    yield Segment(stamp_ns=frames[-1].stamp_ns, sensor=sensor, kind="end", segment_id=name)
