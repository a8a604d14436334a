"""Real people in videos that go on and on: found live, through the processes, by what learnt from other people.

ACTUM_DATA=… ACTUM_POSE_MODEL=… python -m benchmarks.camera.continuous
"""

import os
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import zenoh

from actum import codec, keys
from actum.messages import Action, Segment, Skeleton
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum.recording import Recording
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.supervising import Supervisor
from actum_dataset_importer.clips import Naming, read_clip
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train_to_spot
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.settings import Settings
from som_classifier.presets import DEFAULT

from ..originals import original
from ..page import versions_of
from ..recognition.scores import table
from .joined_clips import BACKGROUND, FRAMES_PER_SECOND, STILL_FRAMES, Joined, joined, stamp_ns

PAGE = Path(__file__).with_name("continuous.md")
LIVE = ServiceSettings(connect="tcp/127.0.0.1:7461")
TEACHERS, WATCHED = ("3", "4", "5", "6"), ("1", "2")
"""People of the Florence clips: those who teach, and those who are watched live."""
ARGUMENTS = {"som_classifier": ("--segments", "auto")}
WHOLE = Naming.of(r"(?P<action>.*)", "")
EXERCISES = "exercises"
LATENCIES = ("latency in the stream, s", "on the clock, s")
READY_S, PATIENCE_S = 60.0, 3.0
"""How long the processes may take to be ready, and how long answers are waited for after the last picture."""
ANYBODY = 1
"""There is one person in each video; the number that tracking gives may change at a cut."""


@dataclass(frozen=True)
class Watched:
    """What arrived while a video was played: each message with the instant of its arrival, machine's clock (ns)."""

    skeletons: Sequence[tuple[Skeleton, int]]
    actions: Sequence[tuple[Action, int]]

    @property
    def first_ns(self) -> int:
        """Stamp of the first picture."""
        return self.skeletons[0][0].stamp_ns

    def newest_ns(self, at_ns: int) -> int:
        """Return the stamp of the newest skeleton that had arrived at an instant."""
        return max((skeleton.stamp_ns for skeleton, arrived_ns in self.skeletons if arrived_ns <= at_ns), default=0)

    @property
    def late_s(self) -> float:
        """Return the median time from a picture's stamp to its skeleton's arrival."""
        return float(np.median([at_ns - skeleton.stamp_ns for skeleton, at_ns in self.skeletons])) / SECOND_NS

    def found(self, video: str, joined: Joined | None, decided_ns: Callable[[int], int]) -> Found:
        """Return what is scored; `decided_ns` turns the instant of an answer's arrival into that of its decision."""
        detections = [
            Detection(video, ANYBODY, a.start_ns, a.end_ns, decided_ns(at_ns), a.action, a.confidence)
            for a, at_ns in self.actions
            if a.valid and a.action is not None and a.end_ns is not None
        ]
        truths = [
            Truth(video, ANYBODY, self.first_ns + stamp_ns(part.first), self.first_ns + stamp_ns(part.last), part.label)
            for part in (joined.actions if joined else ())
        ]
        seen = Stretch(video, ANYBODY, self.first_ns, self.skeletons[-1][0].stamp_ns)
        return Found(detections, truths, [seen])


class Ear:
    """Hears skeletons and final actions."""

    def __init__(self) -> None:
        self.skeletons: list[tuple[Skeleton, int]] = []
        self.actions: list[tuple[Action, int]] = []
        self._lock = threading.Lock()

    def arrived(self, sample: zenoh.Sample) -> None:
        """Note what arrives."""
        now_ns = time.time_ns()
        message = codec.decode(str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding))
        with self._lock:
            if isinstance(message, Skeleton):
                self.skeletons.append((message, now_ns))
            elif isinstance(message, Action) and message.final:
                self.actions.append((message, now_ns))


def main() -> None:
    clips = original("florence3d_rgb")
    exercise = original("people_video/exercise.avi")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = taught(clips, folder)
        videos = {f"person {person}": joined(clips, person, folder / f"{person}.avi") for person in WATCHED}
        watched = {video: live(each.path, model, mirrored=True) for video, each in videos.items()}
        watched[EXERCISES] = live(exercise, model, mirrored=False)
    page = "\n\n".join([*header(videos), *results(watched, videos)])
    print(page)
    PAGE.write_text(page + "\n")


def taught(clips: Path, folder: Path) -> Path:
    """Train on the joined videos of those who teach, as the camera source sees them; return the model's file."""
    recordings = [recorded(joined(clips, person, folder / f"{person}.avi"), folder) for person in TEACHERS]
    samples = samples_from(recordings)
    path = folder / "model.npz"
    train_to_spot(samples.usable, samples.streams, DEFAULT).save(path)
    return path


def recorded(video: Joined, folder: Path) -> Recording:
    """Estimate the poses in a joined video, and mark what is labelled."""
    return seen(video.path, folder / f"{video.person}.mcap", True, video.person, video.marks(LIVE.sensor))


def seen(video: Path, path: Path, mirrored: bool, person: str = "", marks: Sequence[Segment] = ()) -> Recording:
    """Estimate the poses in a video as the camera source does, and store them with marks."""
    settings = Settings(people=1, mirrored=mirrored)
    take = read_clip(video, WHOLE, LIVE.sensor, optics_of(settings), partial(estimator_of, settings))
    with Recorder(path, person=person, source="video", **take.metadata) as recorder:
        for message in (*take.frames, *marks):
            recorder.write(message)
    return Recording(path)


def live(video: Path, model: Path, mirrored: bool) -> Watched:
    """Play a video in real time through the processes, and hear what they put."""
    os.environ.update(processes.common(LIVE))
    ear = Ear()
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(model.with_name("log")))
        supervisor.start(processes.router(LIVE))
        for program in processes.services(LIVE, model, {}, {}):
            supervisor.start(replace(program, arguments=ARGUMENTS.get(program.name, ())))
        client = stack.enter_context(Client(LIVE, wait_s=READY_S))
        for topic in (keys.SKELETON, keys.SEGMENT):
            assert client.wait_for_subscriber(topic, READY_S)
        for topic in (keys.SKELETON, keys.ACTION):
            client.tap(keys.pattern(topic), ear.arrived)
        arguments = ["--source", "camera", "--camera", str(video), "--people", "1", "--no-images"]
        gateway = processes.gateway(LIVE, [*arguments, *(["--mirrored"] if mirrored else [])])
        supervisor.start(gateway)
        began_s = time.monotonic()
        while not ear.skeletons:
            assert time.monotonic() - began_s < READY_S, "no skeleton arrives"
            time.sleep(0.1)
        while time.time_ns() - ear.skeletons[-1][1] < PATIENCE_S * SECOND_NS:
            time.sleep(0.1)
    return Watched(ear.skeletons, ear.actions)


def header(videos: Mapping[str, Joined]) -> Iterator[str]:
    """Say what was run, and how."""
    actions = sum(len(each.actions) for each in videos.values())
    versions = versions_of("mediapipe", "numpy")
    yield "# Found live, from an ordinary camera"
    yield f"""`make bench-camera-continuous`: {versions}, {os.cpu_count()} cores.
All RGB clips of one person of Florence 3D Actions are joined to one video in mixed order, {FRAMES_PER_SECOND} pictures
a second; between two clips the last picture of the one and the first of the other stand for
{STILL_FRAMES / FRAMES_PER_SECOND:.1f} s each, with a cut between. {" and ".join(BACKGROUND).capitalize()} are labelled
nowhere: they are what people do besides. People {", ".join(TEACHERS)} teach, seen in such videos by the camera source;
people {" and ".join(WATCHED)} are watched, {actions} actions, and the video of a person who does exercises and none of
the actions."""
    yield """The videos are played in real time: router, gateway with MediaPipe's pose landmarker, preprocessor,
classifier (`--segments auto`), tracker and fusion run as processes of their own, and nobody marks anything. Found: the
right label and a frame in common, one to one. Latency is from the capture of an action's last picture, median and
90 %: in the stream, to the capture of the newest picture whose skeleton was known when the answer arrived; on the
clock, to the arrival of the answer at another process. Skeletons arrive late by so much after their picture (median):
a file's pictures are not dropped, so that a machine which does not keep pace falls behind."""


def results(watched: Mapping[str, Watched], videos: Mapping[str, Joined]) -> Iterator[str]:
    """Tabulate what was found, and what was missed."""
    yield table(
        ("video", "length, s", "found", "false (a minute of background)", *LATENCIES, "skeletons late by, s"),
        (_row(video, each, videos.get(video)) for video, each in watched.items()),
    )
    yield "Every action that was done, how often it was found, and how often it was told where it was not done:"
    people = [watched[video].found(video, joined, watched[video].newest_ns) for video, joined in videos.items()]
    per_action = scores_of(sum(people, Found())).per_action
    yield table(
        ("action", "done", "found", "told wrongly"),
        (
            [label, str(own.truths), str(own.right), str(own.detections - own.right)]
            for label, own in per_action.items()
        ),
    )
    yield "What was told of the exercises:"
    told = Counter(action.action for action, _ in watched[EXERCISES].actions)
    yield table(("action", "times"), ([str(label), str(times)] for label, times in told.most_common()))


def _row(video: str, watched: Watched, joined: Joined | None) -> list[str]:
    in_stream = scores_of(watched.found(video, joined, watched.newest_ns))
    on_clock = scores_of(watched.found(video, joined, lambda at_ns: at_ns))
    length_s = (watched.skeletons[-1][0].stamp_ns - watched.first_ns) / SECOND_NS
    return [
        video,
        f"{length_s:.0f}",
        f"{in_stream.event.right} of {in_stream.event.truths}" if in_stream.event.truths else "–",
        f"{in_stream.false_detections} ({in_stream.false_per_min or 0:.1f})",
        *("–" if s.latency_s is None else "{:.2f} ({:.2f})".format(*s.latency_s) for s in (in_stream, on_clock)),
        f"{watched.late_s:.2f}",
    ]


if __name__ == "__main__":
    main()
