"""Samples read from recordings: every person's stream, with the labelled segments cut out."""

import logging
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from actum import keys
from actum.node import replay
from actum.recording import Recording
from actum.recording_files import recording_files
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.recorded_segments import FrameCollector, classifier_input, why_unusable
from actum_model_trainer.samples import LabelledStream, Samples, SegmentSample, Unusable
from som_classifier.frames import Frame
from som_classifier.segments import ClosedSegment

log = logging.getLogger("actum")


def select(
    paths: Iterable[Path],
    people: Collection[str] | None = None,
    with_excluded: bool = False,
    remark: Callable[[str], object] = log.warning,
) -> list[Recording]:
    """Open the recordings of some people, or of all (None), each once, as `recording_files` finds them.

    Recordings whose metadata say `excluded: true` are left out, unless `with_excluded`. `remark` is called with a line
    for each unfinished file in a folder.

    Raises:
        RecordingError: a file is no recording.
    """
    found = recording_files(paths)
    for line in found.remarks:
        remark(line)
    return [
        recording
        for recording in map(Recording, found.paths)
        if (people is None or recording.person in people)
        and (with_excluded or recording.metadata.get("excluded") != "true")
    ]


def samples_from(recordings: Sequence[Recording], progress: Progress = silent) -> Samples:
    """Read every person's stream in the recordings, and cut every labelled segment out.

    Raises:
        RecordingError: a file is damaged.
    """
    segments: list[SegmentSample | Unusable] = []
    streams: list[LabelledStream] = []
    for samples in each_read(recordings, progress):
        segments += samples.segments
        streams += samples.streams
    return Samples(segments, streams)


def each_read(recordings: Sequence[Recording], progress: Progress = silent) -> Iterator[Samples]:
    """Read the recordings one by one, and yield what each holds.

    Raises:
        RecordingError: a file is damaged.
    """
    for done, recording in enumerate(recordings):
        progress("reading recordings", done, len(recordings))
        yield _samples_of(recording)
    progress("reading recordings", len(recordings), len(recordings))


def _samples_of(recording: Recording) -> Samples:
    segments: list[SegmentSample | Unusable] = []
    streams: list[LabelledStream] = []
    for sensor in sorted({*recording.sensors(keys.SEGMENT), *recording.sensors(keys.SKELETON)}):
        collected = FrameCollector()
        for _ in replay(collected, classifier_input(recording, sensor)):
            raise AssertionError("the collector puts nothing")
        labelled = [(each, each.label) for each in collected.closed if each.label is not None]
        segments += [_sample(recording, sensor, each, label) for each, label in labelled]
        streams += [
            _stream(recording, agent, frames, [each for each in labelled if each[0].agent == agent])
            for agent, frames in collected.frames.items()
        ]
    return Samples(segments, streams)


def sample_of(
    frames: Sequence[Frame], label: str, recording: Recording, segment_id: str, sensor: str = ""
) -> SegmentSample:
    """Return a sample of valid frames of one person in a recording."""
    kinematics = [frame.kinematics for frame in frames if frame.kinematics is not None]
    return SegmentSample(
        label,
        np.array([frame.stamp_ns for frame in frames]),
        np.array([frame.joints for frame in frames]),
        np.array([frame.motion for frame in frames]),
        np.array([each.posture for each in kinematics]),
        np.array([each.velocity for each in kinematics]),
        recording.person,
        str(recording.path),
        segment_id,
        any(frame.depth_inferred for frame in frames),
        sensor,
    )


def _sample(recording: Recording, sensor: str, closed: ClosedSegment, label: str) -> SegmentSample | Unusable:
    reason = why_unusable(closed)
    if reason is not None:
        return Unusable(str(recording.path), closed.segment_id, reason, sensor)
    return sample_of([frame for frame in closed.frames if frame.valid], label, recording, closed.segment_id, sensor)


def _stream(
    recording: Recording, agent: int, frames: Sequence[Frame], labelled: Sequence[tuple[ClosedSegment, str]]
) -> LabelledStream:
    kinematics = [frame.kinematics for frame in frames if frame.kinematics is not None]
    return LabelledStream(
        np.array([frame.stamp_ns for frame in frames]),
        np.array([frame.motion for frame in frames]),
        np.array([each.posture for each in kinematics]),
        np.array([each.velocity for each in kinematics]),
        tuple((segment.start_ns, segment.end_ns, label) for segment, label in labelled if segment.reason is None),
        recording.person,
        str(recording.path),
        agent,
        any(frame.depth_inferred for frame in frames),
    )
