"""A take from a video file: the person is found in each frame as the gateway does it, then the examples are cut."""

from collections.abc import Iterator
from pathlib import Path

from actum.commands import Refusal
from actum.messages import Segment, Skeleton
from actum.node import Counters
from actum.recording import Recorder
from actum_model_trainer.cutting.courses import PersonTracks
from actum_model_trainer.cutting.repetitions import cut
from actum_model_trainer.progress import Progress
from actum_model_trainer.teaching.take_files import CREATED, OF_THE_TAKE, cut_marks, finish_take
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.devices.video import frame_count, pictures_of
from sensor_gateway.perceiver import Perceiver
from sensor_gateway.settings import Settings


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
        marks, doubts = _recorded(video, recorder, label, count, progress)
    except ValueError as error:
        recorder.discard()
        raise Refusal(str(error)) from None
    finish_take(recorder, marks, doubts)
    return len(marks) // 2, doubts.get(OF_THE_TAKE, [])


def _recorded(
    video: Path, recorder: Recorder, label: str, count: int | None, progress: Progress
) -> tuple[list[Segment], dict[str, list[str]]]:
    """Store the skeletons of a video; return the marks of what is cut out of them, and doubts by segment id."""
    tracks, sensor = PersonTracks(), ""
    for skeleton in _skeletons(video, progress):
        sensor = skeleton.sensor
        recorder.write(skeleton)
        tracks.take(skeleton)
    cuts = cut(tracks.courses(), count, 0)
    if cuts is None:
        raise Refusal("nobody is seen moving in the video: film the whole person, from the front, in good light")
    return cut_marks(cuts, label, sensor)


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
