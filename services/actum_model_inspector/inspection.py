"""The pictures of a model and of segments that it answered, each with its caption, and their writing to files."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from actum_model_inspector.action_map import action_map
from actum_model_inspector.answer_timeline import timeline_picture
from actum_model_inspector.answered import AnsweredSegment, headline
from actum_model_inspector.arm_map import arm_map
from actum_model_inspector.confusion import confusion_picture
from actum_model_inspector.folder import PAGE, clear, note
from actum_model_inspector.posture_map import posture_map
from actum_model_inspector.reliability_diagram import labelled_answers, reliability_picture
from actum_model_inspector.segment_selection import examples, file_names, mistake_name, mistakes
from actum_model_inspector.style import save
from actum_model_inspector.trace_picture import trace_picture
from actum_model_inspector.velocity_map import velocity_map
from actum_model_trainer.calibration_error import MIN_ANSWERS
from actum_model_trainer.evaluation import Evaluation
from actum_model_trainer.progress import Progress, silent
from som_classifier.model import Model
from som_classifier.model_maps import ModelMaps, maps_of


@dataclass(frozen=True)
class Picture:
    """A picture that is to be made.

    Attributes:
        section: the heading of the page under which it stands.
        name: of its file, without the ending.
        caption: how to read it.
        make: the function that draws it.
    """

    section: str
    name: str
    caption: str
    make: Callable[[], Figure]


def pictures(model: Model, segments: Sequence[AnsweredSegment], evaluation: Evaluation | None) -> Iterator[Picture]:
    """Yield the pictures of a model's maps and of segments, where there are any, in the order of the page."""
    maps = maps_of(model)
    if maps is not None:
        yield from _of_maps(maps, segments)
    if evaluation is not None and evaluation.n:
        yield from _of_answers(segments, evaluation)
    chosen = examples(segments)
    names = file_names(chosen)
    for action, example in chosen.items():
        yield from _of_segment(model, f"{action}: an example", names[action], example)
    for number, mistake in enumerate(mistakes(segments), start=1):
        yield from _of_segment(model, f"Mistake {number}: {headline(mistake)}", mistake_name(number), mistake)


def write(planned: Sequence[Picture], folder: Path, ending: str, progress: Progress = silent) -> Mapping[str, str]:
    """Draw the pictures into a folder, in place of an earlier run's, and return each one's file name by its name.

    Raises:
        OSError: one cannot be written, one of an earlier run not be removed, or another file has the name of one.
    """
    files = {picture.name: f"{picture.name}.{ending}" for picture in planned}
    clear(folder, [*files.values(), PAGE])
    for done, picture in enumerate(planned):
        progress("drawing pictures", done, len(planned))
        save(picture.make(), folder / files[picture.name])
        note(folder / files[picture.name])
    progress("drawing pictures", len(planned), len(planned))
    return files


def _of_maps(maps: ModelMaps, segments: Sequence[AnsweredSegment]) -> Iterator[Picture]:
    section = "What it has learnt"
    yield Picture(
        section, "posture-map",
        "The first layer. Every unit stands for a posture, drawn as a figure; like postures lie side by side, and a "
        "darker ground means that neighbours differ more. An action is a way across this map.",
        partial(posture_map, maps),
    )  # fmt: skip
    yield from _of_movement_maps(maps, section)
    yield Picture(
        section, "action-map",
        "The second layer. Every place belongs to the action whose neuron answers most to what falls there; like "
        "actions are neighbours, and the paler, the closer the decision."
        + (" Each dot is a segment; a ring marks a wrong answer." if segments else ""),
        partial(action_map, maps, segments),
    )  # fmt: skip


def _of_movement_maps(maps: ModelMaps, section: str) -> Iterator[Picture]:
    if maps.velocities is not None:
        yield Picture(
            section, "movement-map",
            "The first layer's second map. Every unit stands for a way of moving, drawn as arrows at the joints.",
            partial(velocity_map, maps.velocities),
        )  # fmt: skip
    if maps.arms is not None:
        left = "Who acts with the left arm is read in a mirror" if maps.mirrors else "Left arms are not seen by it"
        yield Picture(
            section, "arm-map",
            "The first layer's third map. Every unit stands for where the right arm is, seen from its shoulder, and "
            f"where it is going. {left}.",
            partial(arm_map, maps.arms, maps.mirrors),
        )  # fmt: skip


def _of_answers(segments: Sequence[AnsweredSegment], evaluation: Evaluation) -> Iterator[Picture]:
    section = "How often it is right"
    yield Picture(
        section, "confusion",
        "Rows are what was done, columns what it was taken for. On the diagonal the answer was right; dark cells "
        "elsewhere are pairs of actions that the model mixes up.",
        partial(confusion_picture, evaluation),
    )  # fmt: skip
    if len(labelled_answers(segments)) >= MIN_ANSWERS:
        yield Picture(
            section, "reliability",
            "Whether its confidence can be taken at its word: beneath the dashed line it is surer than it is right.",
            partial(reliability_picture, segments),
        )  # fmt: skip


def _of_segment(model: Model, section: str, name: str, answered: AnsweredSegment) -> Iterator[Picture]:
    maps, where = maps_of(model), f"Segment {answered.segment_id} of {Path(answered.file).name}"
    if maps is not None:
        yield Picture(
            section, f"trace-{name}",
            f"{where}: its way over the posture map, from postures framed dark at the start to light ones at the end.",
            partial(trace_picture, maps, answered),
        )  # fmt: skip
    yield Picture(
        section, f"time-{name}",
        "How the answer came about while it went on: each action's neuron, the decision with its confidence, and the "
        "actor. Where the thick line is above all others for good, the action was recognised. Until the end more may "
        "come; the last bar and the last points are the answer to the complete action, and may jump.",
        partial(timeline_picture, model, answered),
    )  # fmt: skip
