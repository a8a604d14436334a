"""Ten events that one person's model told or held back wrongly, corrected as on the page, and the model made anew.

ACTUM_DATA=… ACTUM_POSE_MODEL=… python -m benchmarks.camera.correcting
"""

import os
import platform
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from actum import keys
from actum.commands import Refusal
from actum.messages import Action, HeldBack, Message, Segment
from actum.node import Tick, replay
from actum.recording import Recording
from actum_examples.take import read_take
from actum_model_trainer.recorded_segments import classifier_input
from model_trainer.settings import Settings
from model_trainer.trainer import ModelTrainer
from som_classifier.model import Model
from som_classifier.model_loading import load_model
from som_classifier.node import SomClassifier
from som_classifier.segmentation import Segmentation

from ..originals import original
from ..recognition.scores import table
from .continuous import LIVE, TEACHERS, WATCHED, recorded, seen
from .joined_clips import joined

PAGE = Path(__file__).with_name("correcting.md")
COLUMNS = (
    "taught by", "corrected: right afterwards", "other right events: kept", "told rightly", "told wrongly",
    "training, s", "corrections, s", "update, s",
)  # fmt: skip
HEADER = """# Corrected by clicks

`python -m benchmarks.camera.correcting`: {versions}. One person of Florence 3D Actions teaches by the joined video of
[continuous.md](continuous.md), through the page's trainer and its real jobs. Two others and a person who exercises are
watched, unmarked. The first ten events that were told wrongly, or held back wrongly, are corrected as by clicks on the
page, as what was done or as none of the actions; then the model is updated, and the same videos are watched again.
An event of fewer than eight frames is refused, and counts as not right. How corrections are
learnt was decided with a look at these people."""
Done = tuple[int, int, str]
"""Start, end (ns) and label of what was done."""
SET = "corrected"
CORRECTIONS = 10
COMMON_SHARE = 0.5
"""Of the shorter of two spans: from this on they are of the same event."""
LOOK_S = 0.05


@dataclass(frozen=True)
class Answer:
    """What was said of a span: the action that was told, or held back."""

    agent: int
    start_ns: int
    end_ns: int
    label: str
    told: bool

    def meets(self, start_ns: int, end_ns: int) -> bool:
        """Return whether it is of the same event as this span."""
        common_ns = min(self.end_ns, end_ns) - max(self.start_ns, start_ns)
        return common_ns >= COMMON_SHARE * min(self.end_ns - self.start_ns, end_ns - start_ns)


@dataclass(frozen=True)
class Wrong:
    """An answer, and what was really done; empty where it was none of the actions."""

    video: Recording
    answer: Answer
    really: str

    def is_right(self, after: Sequence[Answer]) -> bool:
        """Return whether what is said afterwards is right."""
        told = [each for each in after if each.told and each.meets(self.answer.start_ns, self.answer.end_ns)]
        return {each.label for each in told} == ({self.really} if self.really else set())


class Teaching:
    """A trainer with its real jobs, asked as the page asks it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._trainer = ModelTrainer.configured(Settings.model_validate({"trainer_data": folder}))
        self._commands = {command.name: command for command in self._trainer.commands}
        self.ask("create_set", set=SET)

    def ask(self, command: str, **fields: Any) -> dict[str, Any]:
        """Ask, and return the reply."""
        return self._commands[command].obey(fields)

    def add(self, take: Recording) -> None:
        """Put a recording into the set."""
        (self._folder / "sets" / SET / take.path.name).write_bytes(take.path.read_bytes())

    def watch(self, video: Recording, wrong: Sequence[Wrong]) -> float:
        """Let the trainer see a video's frames, then say what was really done; return how long that took (s)."""
        for message in video.messages((keys.SKELETON,)):
            list(self._trainer.handle(message))
        began_s = time.monotonic()
        for each in wrong:
            span = {"start_ns": each.answer.start_ns, "end_ns": each.answer.end_ns, "agent": each.answer.agent}
            with suppress(Refusal):  # too few frames to learn from
                self.ask("correct", set=SET, label=each.really, **span)
        return time.monotonic() - began_s

    def model(self, update: str | None = None) -> Model:
        """Train on the set, or update the model of an id; put it into use, and load it as the classifier does."""
        job = self.ask("train", set=SET, update=update)
        while job["state"] == "running":
            time.sleep(LOOK_S)
            list(self._trainer.handle(Tick(time.monotonic_ns())))
            job = self.ask("job", job=job["id"])
        assert job["state"] == "done", job
        self.ask("activate", model=job["result"]["model"])
        return load_model(self._folder / "model.npz")


def answers(model: Model, video: Recording) -> list[Answer]:
    """Return what a classifier says of a video that nobody marks, told and held back, in order."""
    node = SomClassifier(model, segmentation=Segmentation("auto"))
    postures = ((at_ns, m) for at_ns, m in classifier_input(video, LIVE.sensor) if not isinstance(m, Segment))
    return list(_answers(replay(node, postures)))


def _answers(said: Iterable[Message]) -> Iterator[Answer]:
    for message in said:
        if isinstance(message, HeldBack) and message.why == "unknown":
            yield Answer(message.agent, message.start_ns, message.end_ns, message.action, told=False)
        elif isinstance(message, Action) and message.final and message.action and message.end_ns:
            yield Answer(message.agent, message.start_ns, message.end_ns, message.action, told=True)


def done_in(video: Recording) -> list[Done]:
    """Return what is done in a video."""
    return [(each.start_ns or 0, each.end_ns or 0, each.label or "") for each in read_take(video).examples]


def wrong_answers(model: Model, video: Recording, said: Sequence[Answer]) -> list[Wrong]:
    """Return the answers that somebody who knows the actions would correct: told wrongly, or held back wrongly."""
    found = []
    for answer in said:
        really = next((label for *span, label in done_in(video) if answer.meets(*span)), "")
        if really not in (*model.labels, ""):
            continue
        if (answer.told and really != answer.label) or (not answer.told and really):
            found.append(Wrong(video, answer, really))
    return found


@dataclass(frozen=True)
class Corrected:
    """What corrections gave.

    Attributes:
        wrong: what was corrected.
        mended: how many of these are right afterwards.
        kept: of the other events that were told rightly before, how many are afterwards, and of how many.
        right: actions that were told rightly before and after.
        false: events that were told wrongly before and after.
        first_s: time of the first training, until its model is loaded.
        asked_s: time of all corrections.
        again_s: time of the training with them.
    """

    wrong: Sequence[Wrong]
    mended: int
    kept: tuple[int, int]
    right: tuple[int, int]
    false: tuple[int, int]
    first_s: float
    asked_s: float
    again_s: float

    @property
    def row(self) -> list[str]:
        """The table's row without its first cell."""
        pairs = ("{} → {}".format(*pair) for pair in (self.right, self.false))
        times = (f"{self.first_s:.1f}", f"{self.asked_s:.2f}", f"{self.again_s:.1f}")
        return [f"{self.mended} of {len(self.wrong)}", "{} of {}".format(*self.kept), *pairs, *times]


def corrected(teaching: Recording, videos: Sequence[Recording], folder: Path) -> Corrected:
    """Train on one person, correct what is wrong in videos of others, train anew, and look again."""
    trainer = Teaching(folder)
    trainer.add(teaching)
    model, first_s = timed(trainer.model)
    before = {video.path: answers(model, video) for video in videos}
    wrong = [each for video in videos for each in wrong_answers(model, video, before[video.path])][:CORRECTIONS]
    asked_s = sum(trainer.watch(video, [each for each in wrong if each.video is video]) for video in videos)
    again, again_s = timed(partial(trainer.model, model.id))
    after = {video.path: answers(again, video) for video in videos}
    told = [(video, each) for video in videos for each in rightly_told(video, before[video.path])]
    kept = sum(each in rightly_told(video, after[video.path]) for video, each in told)
    right = tuple(sum(len(rightly_told(video, said[video.path])) for video in videos) for said in (before, after))
    false = tuple(sum(falsely_told(video, said[video.path]) for video in videos) for said in (before, after))
    mended = sum(each.is_right(after[each.video.path]) for each in wrong)
    return Corrected(wrong, mended, (kept, len(told)), right, false, first_s, asked_s, again_s)  # type: ignore[arg-type]


def timed(made: Callable[[], Model]) -> tuple[Model, float]:
    """Return what a function makes, and how long it took (s)."""
    began_s = time.monotonic()
    return made(), time.monotonic() - began_s


def rightly_told(video: Recording, said: Sequence[Answer]) -> list[Done]:
    """Return what was done and is told with its label."""
    return [done for done in done_in(video) if any(a.told and a.label == done[2] and a.meets(*done[:2]) for a in said)]


def falsely_told(video: Recording, said: Sequence[Answer]) -> int:
    """Count what is told and was not done."""
    done = done_in(video)
    return sum(not any(a.label == each[2] and a.meets(*each[:2]) for each in done) for a in said if a.told)


def main() -> None:
    clips, exercise = original("florence3d_rgb"), original("people_video/exercise.avi")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        takes = {
            person: recorded(joined(clips, person, folder / f"{person}.avi"), folder)
            for person in (*TEACHERS, *WATCHED)
        }
        videos = [*(takes[person] for person in WATCHED), seen(exercise, folder / "exercise.mcap", mirrored=False)]
        rows = [[teacher, *corrected(takes[teacher], videos, folder / f"by {teacher}").row] for teacher in TEACHERS]
    versions = f"Python {platform.python_version()}, {os.cpu_count()} cores"
    page = "\n\n".join([HEADER.format(versions=versions), table(COLUMNS, rows)])
    print(page)
    PAGE.write_text(page + "\n")


if __name__ == "__main__":
    main()
