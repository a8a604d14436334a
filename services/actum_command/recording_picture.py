"""The picture of a recording for `actum label picture`: what is drawn, and where the answers come from."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from actum import keys
from actum.messages import Action
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_examples.cutting.courses import RATE_HZ, Course, recorded_courses
from actum_examples.take import Take
from actum_model_inspector.answered import encoded
from actum_model_inspector.stream_picture import Lane, Span, SpeedLine, stream_picture
from actum_model_inspector.style import save
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.recorded_segments import classifier_input, closed_segments, sensors
from som_classifier.model import Model
from som_classifier.spotting.spotted import SpottingOptions

REJECTED = "rejected"
"""What stands in place of an answer to a segment that was not recognised."""


def write_picture(take: Take, model: Model | None, output: Path) -> None:
    """Draw a recording with its segments, and a model's answers to them or the recorded ones.

    Of a model that can, what it finds without the marks is drawn, too.

    Raises:
        RecordingError: the file is damaged.
        OSError: the picture cannot be written.
    """
    recording, first_ns = take.recording, take.first_ns
    courses = [each for sensor in recording.sensors(keys.SKELETON) for each in recorded_courses(recording, sensor)]
    marked = [
        _span(*each.bounds_ns, first_ns, each.label, str(number))
        for number, each in enumerate(take.segments, start=1)
        if each.bounds_ns is not None
    ]
    lanes = _recorded(recording, first_ns) if model is None else _of_model(recording, first_ns, model)
    whose = (
        "the recorded answers"
        if model is None
        else f"what model {model.id} answers to the marks, and finds without them"
    )
    acting = [segment.agent for segment in take.segments if segment.agent is not None]
    save(
        stream_picture(
            f"{recording.path.name}: {len(take.segments)} segments",
            _speed_lines(courses, acting, first_ns),
            marked,
            lanes,
            whose,
        ),
        output,
    )


def _speed_lines(courses: Sequence[Course], acting: Sequence[int], first_ns: int) -> list[SpeedLine]:
    """Return each person's speeds, with a gap where nobody saw them; who acts in most segments comes first."""
    agents = sorted({course.agent for course in courses}, key=lambda agent: (-acting.count(agent), agent))
    lines = []
    for agent in agents:
        own = [course for course in courses if course.agent == agent]
        times_s = [
            (course.start_ns - first_ns) / SECOND_NS + np.arange(len(course.speeds_mps) + 1) / RATE_HZ for course in own
        ]
        speeds_mps = [np.append(course.speeds_mps, np.nan) for course in own]
        lines.append(SpeedLine(f"agent {agent}", np.concatenate(times_s), np.concatenate(speeds_mps)))
    return lines


def _recorded(recording: Recording, first_ns: int) -> list[Lane]:
    """Return the recorded answers, where there are any."""
    answers = [
        _span(message.start_ns, message.end_ns, first_ns, message.action, f"{message.confidence:.2f}")
        if message.valid and message.action is not None
        else _span(message.start_ns, message.end_ns, first_ns, None, REJECTED)
        for message in recording.messages((keys.ACTION,))
        if isinstance(message, Action) and message.final and message.end_ns is not None
    ]
    return [Lane("answer", answers)] if answers else []


def _of_model(recording: Recording, first_ns: int, model: Model) -> list[Lane]:
    """Return a model's answers to the marked segments, where there are any, and what it finds without their marks."""
    answers = list(_recognised(recording, first_ns, model))
    lanes = [Lane("answer", answers)] if answers else []
    if model.spotter(SpottingOptions()) is not None:
        found = [
            _span(each.start_ns, each.end_ns, first_ns, each.label, f"{each.confidence:.2f}")
            for each in found_by(model, [recording]).detections
        ]
        lanes.append(Lane("found", found))
    return lanes


def _recognised(recording: Recording, first_ns: int, model: Model) -> Iterator[Span]:
    """Yield a model's answers to the marked segments."""
    for sensor in sensors(recording):
        for closed in closed_segments(classifier_input(recording, sensor)):
            valid = [frame for frame in closed.frames if frame.valid]
            if closed.reason or len(valid) < model.min_frames:
                yield _span(closed.start_ns, closed.end_ns, first_ns, None, REJECTED)
            else:
                answer = model.recognise(encoded(model, valid), complete=True)
                yield _span(closed.start_ns, closed.end_ns, first_ns, answer.label, f"{answer.confidence:.2f}")


def _span(start_ns: int, end_ns: int, first_ns: int, label: str | None, note: str) -> Span:
    return Span((start_ns - first_ns) / SECOND_NS, (end_ns - first_ns) / SECOND_NS, label, note)
