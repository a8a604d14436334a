"""A take from a video file: the person is found in each frame as the gateway does it, then the examples are cut."""

from collections.abc import Iterator
from pathlib import Path

from actum.commands import Refusal
from actum.messages import CUT, Skeleton, segment_marks
from actum.node import Counters
from actum.recorder import Recorder
from actum_examples.cutting.courses import PersonTracks
from actum_examples.cutting.repetitions import cut
from actum_examples.marking import Marking, finish_take, marking_of
from actum_examples.take import CREATED, OF_THE_TAKE
from actum_model_trainer.progress import Progress
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.devices.video import frame_count, pictures_of
from sensor_gateway.perceiver import Perceiver
from sensor_gateway.settings import Settings

FEWEST_FRAMES = 5
"""Frames with a person that a clip needs: with fewer a model would answer nothing."""
WHOLE = "the video was too short to find repetitions in, so all of it is one example"


def take_of_video(
    video: Path, output: Path, label: str, person: str, count: int | None, created: str, progress: Progress
) -> tuple[int, list[str]]:
    """Write the take of a video; return the number of its examples, and what may be wrong with them.

    Raises:
        Refusal: the file is no video, there is no pose model, or nobody moves in it.
        OSError: the take cannot be written.
    """
    recorder = Recorder(output, person=person, source=f"video {video.name}", **{CREATED: created})
    try:
        marking = _recorded(video, recorder, label, count, progress)
    except ValueError as error:
        recorder.discard()
        raise Refusal(str(error)) from None
    finish_take(recorder, marking)
    return len(marking.marks or ()) // 2, marking.doubts.get(OF_THE_TAKE, [])


def _recorded(video: Path, recorder: Recorder, label: str, count: int | None, progress: Progress) -> Marking:
    """Store the skeletons of a video, and mark the examples in it."""
    tracks, seen = PersonTracks(), list[Skeleton]()
    for skeleton in _skeletons(video, progress):
        recorder.write(skeleton)
        tracks.receive(skeleton)
        seen += [skeleton] if skeleton.agents else []
    cuts = cut(tracks.courses(), count, 0)
    if cuts is not None:
        return marking_of(cuts, count, label, seen[0].sensor)
    if len(seen) < FEWEST_FRAMES or count not in (None, 1):
        raise Refusal("the video shows no person who moves: film the whole person, from the front, in good light")
    whole = seen[0].stamp_ns, seen[-1].stamp_ns, seen[0].sensor
    return Marking(segment_marks(*whole, f"{CUT}-1", label, origin=CUT), {f"{CUT}-1": [WHOLE]})


def _skeletons(video: Path, progress: Progress) -> Iterator[Skeleton]:
    """Yield the skeleton of each frame of a video.

    Raises:
        VideoError, PoseModelError, CalibrationError, ValidationError: as the gateway would refuse it.
    """
    settings, frames = Settings(people=1), frame_count(video)
    with estimator_of(settings) as estimator:
        perceiver = Perceiver(estimator, optics_of(settings), settings.sensor, video.stem, Counters())
        for done, picture in enumerate(pictures_of(video)):
            progress("finding the person", done, frames)
            yield perceiver.skeleton(picture)
