"""What every picture has to be, whatever the model and the recordings."""

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text

from actum.messages import Segment
from actum.recording import Recording
from actum.som import Som
from actum_model_inspector.action_map import action_map
from actum_model_inspector.answer_timeline import timeline_picture
from actum_model_inspector.answered import AnsweredSegment, answered_segments
from actum_model_inspector.confusion import confusion_picture
from actum_model_inspector.inspection import Picture, pictures, write
from actum_model_inspector.posture_map import MAX_FIGURES, drawn_units
from actum_model_inspector.style import action_colours
from actum_model_trainer.evaluation import Evaluation, Prediction, evaluate
from handmade import paper_model
from people import FRAME_NS, STANDING, lacking, skeleton
from performers import mark, performance
from som_classifier.model_maps import ModelMaps, PaperMaps, PyramidMaps
from som_classifier.paper_model import PaperMetadata, PaperModel
from som_classifier.supervised import SupervisedLayer

Record = Callable[..., Recording]
SMALLEST_PX = 400


@pytest.fixture(autouse=True)
def coarse(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Few dots where only the lines matter."""
    if "sound" not in request.node.name:
        monkeypatch.setattr("actum_model_inspector.style.DOTS_PER_INCH", 30)


def texts(figure: object) -> dict[str, tuple[float, float]]:
    assert hasattr(figure, "axes")
    return {
        text.get_text(): text.get_position() for text in figure.axes[0].findobj(Text) if text.get_text() and text.axes
    }


def drawn(planned: list[Picture], folder: Path, ending: str = "png") -> list[Path]:
    return [folder / file for file in write(planned, folder, ending).values()]


def test_every_picture_of_a_model_and_a_recording_is_a_sound_png(
    maps: ModelMaps, recording: Recording, segments: list[AnsweredSegment], tmp_path: Path
) -> None:
    planned = list(pictures(maps.model, segments, evaluate(maps.model, [recording])))
    names = {picture.name for picture in planned}
    assert {"posture-map", "action-map", "confusion", "trace-push", "time-lift"} <= names
    assert ({"movement-map", "arm-map"} <= names) == isinstance(maps, PyramidMaps)
    of_lifting = [picture for picture in planned if not picture.name.endswith(("push", "swing", "1", "2", "3"))]
    for file in drawn(of_lifting, tmp_path):
        assert min(imread(file).shape[:2]) > SMALLEST_PX


def test_pictures_of_a_model_alone_are_its_maps(maps: ModelMaps) -> None:
    names = [picture.name for picture in pictures(maps.model, [], None)]
    assert names == ["posture-map", *["movement-map", "arm-map"] * isinstance(maps, PyramidMaps), "action-map"]


def test_svg_files_parse_and_the_same_picture_makes_the_same_file(maps: ModelMaps, tmp_path: Path) -> None:
    planned = [picture for picture in pictures(maps.model, [], None) if picture.name == "action-map"]
    (file,) = drawn(planned, tmp_path, "svg")
    first = file.read_bytes()
    assert ElementTree.fromstring(first).tag.endswith("svg")
    drawn(planned, tmp_path, "svg")
    assert file.read_bytes() == first


def test_pictures_leave_other_people_s_parameters_alone(maps: ModelMaps, tmp_path: Path) -> None:
    before = dict(mpl.rcParams)
    drawn(list(pictures(maps.model, [], None))[-1:], tmp_path)
    assert dict(mpl.rcParams) == before


def test_names_stand_where_their_actions_are() -> None:
    written = texts(action_map(PaperMaps(paper_model())))
    assert written["pull"][0] < 0.5 < written["push"][0]


def test_an_action_without_a_place_is_named_beneath_the_map() -> None:
    model = paper_model()
    deaf = PaperModel(model.layer1, model.layer2, SupervisedLayer(np.array([[1, 0], [1, 0]])), model.metadata)
    axes = action_map(PaperMaps(deaf)).axes[0]
    assert axes.get_xlabel() == "without a place of their own: push"


def many_actions(labels: list[str]) -> PaperMaps:
    about = paper_model().metadata.model_dump() | {"labels": labels}
    rng = np.random.default_rng(1)
    layer2 = Som.random(6, 7, 6, rng)
    layer3 = SupervisedLayer.random(len(labels), 42, rng)
    return PaperMaps(PaperModel(paper_model().layer1, layer2, layer3, PaperMetadata.model_validate(about)))


@pytest.mark.thorough
@pytest.mark.parametrize(
    "labels",
    [
        [f"action {number}" for number in range(25)],
        ["a name that goes on and on " * 6, "put_down_the_thing_that_was_picked_up_before_it_was_put_down"],
        ["costs $5 and {x}", "_hidden $", "<b>&amp;"],
        ["\ue000\ue001", "two\nlines\tand \x07 bell"],
    ],
    ids=["many", "long", "odd", "undrawable"],
)
def test_many_long_and_odd_names_are_drawn(labels: list[str], record: Record, tmp_path: Path) -> None:
    maps = many_actions(labels)
    skeletons, marks = performance(["push"])
    recording = record(skeletons, [marks[0].model_copy(update={"label": labels[0]}), marks[1]])
    segments = answered_segments(maps.model, [recording])
    planned = list(pictures(maps.model, segments, evaluate(maps.model, [recording])))
    chosen = [picture for picture in planned if not picture.name.startswith(("posture", "trace"))]
    assert all(imread(file).size for file in drawn(chosen, tmp_path))


@pytest.mark.parametrize(
    "label", ["pick_up_the_cup_and_then_put_it_back", "put down what was taken up", "PICK UP CUP NOW"]
)
def test_no_name_leaves_the_page(label: str, record: Record) -> None:
    maps = many_actions([label, f"{label} again"])
    skeletons, marks = performance(["push"])
    recording = record(skeletons, [marks[0].model_copy(update={"label": label}), marks[1]])
    (answered,) = answered_segments(maps.model, [recording])
    confusion = confusion_picture(evaluate(maps.model, [recording]))
    for figure in (timeline_picture(maps.model, answered), action_map(maps), confusion):
        assert beyond_the_page(figure) == []


def beyond_the_page(figure: Figure) -> list[str]:
    """Name the texts that are not wholly on the page, give or take two dots."""
    figure.draw_without_rendering()
    page = figure.bbox.padded(2)
    drawn_texts = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    boxes = [(text.get_text(), text.get_window_extent()) for text in drawn_texts]
    return [name for name, box in boxes if not (page.contains(*box.min) and page.contains(*box.max))]


def test_the_names_of_mistakes_cover_no_other_name() -> None:
    maps = many_actions([f"action {number}" for number in range(4)])
    mistakes = [AnsweredSegment("file", "2", str(unit), "lift up", [], action_unit=unit) for unit in range(42)]
    figure = action_map(maps, mistakes)
    figure.draw_without_rendering()
    boxes = {text: text.get_window_extent() for text in figure.axes[0].texts}
    named = [text for text in boxes if text.get_text() == "lift up"]
    assert named
    assert all(not boxes[name].count_overlaps([boxes[other] for other in boxes if other is not name]) for name in named)


def test_the_one_instant_of_the_shortest_segment_is_a_dot(maps: ModelMaps, record: Record) -> None:
    skeletons, _ = performance(["push"])
    recording = record(skeletons, still(maps.model.min_frames))
    (answered,) = answered_segments(maps.model, [recording])
    axes = timeline_picture(maps.model, answered).axes[0]
    assert {line.get_marker() for line in axes.lines} == {"o"}


def test_segments_without_labels_get_pictures_but_no_confusion(maps: ModelMaps, record: Record, tmp_path: Path) -> None:
    skeletons, _ = performance(["push"])
    recording = record(skeletons, [mark("start", 0, "a"), mark("end", 19 * FRAME_NS, "a")])
    planned = list(pictures(maps.model, answered_segments(maps.model, [recording]), None))
    assert not any(picture.name == "confusion" for picture in planned)
    assert len(drawn([picture for picture in planned if picture.name.startswith(("time", "action"))], tmp_path)) == 2


def still(stamps: int) -> list[Segment]:
    return [mark("start", 0, "a", "push"), mark("end", (stamps - 1) * FRAME_NS, "a")]


@pytest.mark.parametrize("missing", [(), ("head", "left_hand", "right_foot")], ids=["none", "three"])
def test_a_still_actor_with_joints_missing_is_drawn(
    maps: ModelMaps, record: Record, tmp_path: Path, missing: tuple[str, ...]
) -> None:
    trembling_m = np.random.default_rng(0).normal(0, 1e-5, (30, 15, 3))
    skeletons = [
        skeleton(number * FRAME_NS, lacking(STANDING + moved, *missing)) for number, moved in enumerate(trembling_m)
    ]
    segments = answered_segments(maps.model, [record(skeletons, still(20))])
    assert segments[0].recognition is not None
    planned = [picture for picture in pictures(maps.model, segments, None) if picture.section.startswith("push")]
    assert len(drawn(planned, tmp_path)) == 2


def test_a_confusion_with_rejections_has_a_column_for_them() -> None:
    predictions = [("push", "push"), ("push", None), ("pull", "push")]
    evaluation = Evaluation(tuple(Prediction("a", str(n), *each) for n, each in enumerate(predictions)))
    axes = confusion_picture(evaluation).axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["pull", "push", "(rejected)"]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["pull", "push"]


@pytest.mark.parametrize(("side", "every"), [(3, 1), (20, 1), (21, 2), (30, 2), (41, 3)])
def test_no_more_figures_are_drawn_than_can_be_seen(side: int, every: int) -> None:
    units, distance = drawn_units(Som(side, 2, np.zeros((side * 2, 9))))
    assert distance == every
    assert len({int(unit) // 2 for unit in units}) <= MAX_FIGURES


def test_each_of_two_dozen_actions_has_a_colour_of_its_own_and_the_next_two_dozen_have_the_same() -> None:
    colours = action_colours(48)
    assert len({tuple(colour) for colour in colours[:24].round(3)}) == 24
    np.testing.assert_array_equal(colours[24:], colours[:24])
