"""The panels on which people teach: recording, mending, training, testing, models, parameters; and hostile input."""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from accessibility import serious_faults
from actum.messages import NONE, HeldBack, Skeleton
from actum.node import SECOND_NS
from lessons import SET, Lesson
from live import wait_until
from model_trainer.job_process import Progressing
from recognisers import tiny_model
from repeating import Stream, rest
from teaching import GOGGLINGS, WAVES, Teacher

pytestmark = pytest.mark.browser
Open = Callable[..., Any]
SET_VALUE = "(it, value) => { it.value = value }"
MARKUP = "<img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which two actions were taught."""
    teacher = Teacher(tmp_path_factory.mktemp("taught"))
    teacher.ask("create_set", set=SET)
    teacher.teach("wave", WAVES)
    teacher.teach("goggles", GOGGLINGS, person="bert")
    return teacher.folder


@pytest.fixture
def teach(room: Lesson, open_page: Open) -> Any:
    page = open_page(f"{room.page.address}#teach")
    examples_of(page, "wave", 5)
    return page


@pytest.fixture
def models(room: Lesson, open_page: Open) -> Any:
    page = open_page(f"{room.page.address}#models")
    page.get_by_role("row", name=SET).wait_for()
    return page


def examples_of(page: Any, label: str, number: int) -> Any:
    """Wait until an action has so many examples, and return them."""
    group = page.get_by_role("region", name=f"Examples of {label}")
    if number:
        group.get_by_text(f"{number} example").wait_for()
    else:
        group.wait_for(state="detached")
    return group.get_by_role("listitem")


def press(page: Any, name: str, within: Any = None) -> None:
    (within or page).get_by_role("button", name=name, exact=True).locator("visible=true").click()


def says(page: Any, card: str, text: str) -> None:
    page.locator(f"#{card}").get_by_text(text).first.wait_for()


def go_to(page: Any, panel: str) -> None:
    page.evaluate("panel => { location.hash = panel; document.activeElement.blur() }", panel)
    page.locator(f"#{panel}").wait_for()


def mark_by_keys(room: Lesson, page: Any) -> None:
    """Mark a start and its end by the switch that is in sight."""
    for _ in range(2):
        before = len(room.put_messages)
        page.keyboard.press(" ")
        wait_until(lambda before=before: len(room.put_messages) == before + 1, "a mark is put")


def fill_in(page: Any, label: str, person: str, count: int) -> None:
    page.get_by_role("combobox", name="Action").locator("visible=true").fill(label)
    page.get_by_role("combobox", name="Person").fill(person)
    page.get_by_role("spinbutton", name="How many times").fill(str(count))


def test_a_take_is_begun_by_keys_counted_along_and_ends_by_itself(room: Lesson, teach: Any) -> None:
    fill_in(teach, "swing", "carla", 3)
    teach.keyboard.press("Enter")
    says(teach, "record", "0 of 3")
    says(teach, "record", "swing, by carla")
    frames = Stream().repeat(WAVES[:3]).then(rest(4)).skeletons(first_ns=10**12)
    room.see(frames[:190])
    says(teach, "record", "2 of 3")
    says(teach, "record", "Resting: now again")
    room.see(frames[190:])
    says(teach, "record", "3 of swing recorded")
    assert examples_of(teach, "swing", 3).count() == 3
    assert "by anna, bert, carla" in teach.locator("#set").text_content()


def test_one_is_stopped_another_dropped_and_background_recorded(room: Lesson, teach: Any) -> None:
    fill_in(teach, "swing", "carla", 5)
    press(teach, "Record")
    says(teach, "record", "0 of 5")
    room.see(Stream().repeat(WAVES[:2]).skeletons(first_ns=10**12))
    press(teach, "Stop")
    says(teach, "record", "only 2 of 5 of swing recorded")
    says(teach, "record", "record 3 more")
    press(teach, "Record")
    press(teach, "Discard")
    says(teach, "record", "Discarded: nothing was kept.")
    press(teach, "Record background")
    says(teach, "record", "0.0 s")
    room.see(Stream().then(rest(12)).skeletons(first_ns=2 * 10**12))
    press(teach, "Stop")
    says(teach, "record", "background recorded")
    examples_of(teach, "swing", 2)


def test_the_space_bar_marks_examples_during_a_take(room: Lesson, teach: Any) -> None:
    fill_in(teach, "swing", "carla", 1)
    press(teach, "Record")
    mark = teach.locator("#take-switch").get_by_role("button", name="Hold to mark")
    wait_until(lambda: mark.evaluate("it => it === document.activeElement"), "the switch has the keyboard")
    frames = Stream().repeat(WAVES[:1]).then(rest(4)).skeletons(first_ns=10**12)
    room.see(frames[:30])
    teach.keyboard.press(" ")
    wait_until(lambda: len(room.put_messages) == 1, "the start is marked")
    room.see(frames[30:80])
    teach.keyboard.press(" ")
    wait_until(lambda: len(room.put_messages) == 2, "the end is marked")
    room.see(frames[80:])
    assert "marked by hand" in examples_of(teach, "swing", 1).first.text_content()


def test_no_two_marks_of_the_page_share_a_name_whichever_switch_makes_them(room: Lesson, teach: Any) -> None:
    fill_in(teach, "swing", "carla", 5)
    press(teach, "Record")
    says(teach, "record", "0 of 5")
    mark_by_keys(room, teach)
    go_to(teach, "live")
    mark_by_keys(room, teach)
    teach.reload()
    teach.locator("#sensor", has_text="kinect0").wait_for()
    mark_by_keys(room, teach)
    names = [mark.segment_id for mark in room.put_messages]
    assert names[::2] == names[1::2], "an end has the name of its start"
    assert len(set(names)) == 3


def test_a_mark_ends_when_its_switch_is_left(room: Lesson, teach: Any) -> None:
    go_to(teach, "live")
    teach.keyboard.press(" ")
    wait_until(lambda: len(room.put_messages) == 1, "the start is marked")
    go_to(teach, "teach")
    wait_until(lambda: [mark.kind for mark in room.put_messages] == ["start", "end"], "the end is marked")


def test_each_example_is_a_film_that_moves_unless_halted(room: Lesson, open_page: Open) -> None:
    teach = open_page(f"{room.page.address}#teach", reduced_motion="no-preference")
    film = teach.get_by_role("img", name="Film of wave 1", exact=True)

    def seen(after_ms: int) -> bytes:
        teach.wait_for_timeout(after_ms)
        return bytes(film.screenshot())

    wait_until(lambda: seen(0) != seen(300), "it moves")
    teach.get_by_role("checkbox", name="Play the films").uncheck()
    assert seen(200) == seen(300)


def test_an_example_is_trimmed_by_keys(room: Lesson, teach: Any) -> None:
    before = room.teacher.examples()[0]
    press(teach, "Trim wave 1")
    start = teach.get_by_role("slider", name="Start")
    start.focus()
    for _ in range(5):
        teach.keyboard.press("ArrowRight")
    teach.get_by_role("slider", name="End").press("ArrowLeft")
    press(teach, "Trim", teach.get_by_role("dialog"))
    says(teach, "examples", "trimmed")
    after = room.teacher.examples()[0]
    assert after["start_ns"] - before["start_ns"] == pytest.approx(0.10e9, abs=1e6)
    assert before["end_ns"] - after["end_ns"] == pytest.approx(0.02e9, abs=1e6)


def test_an_example_is_relabelled_mirrored_deleted_and_escape_changes_nothing(room: Lesson, teach: Any) -> None:
    press(teach, "Relabel wave 1")
    teach.keyboard.press("Escape")
    press(teach, "Relabel wave 1")
    teach.get_by_role("dialog").get_by_role("combobox", name="Action").fill("goggles")
    teach.keyboard.press("Enter")
    examples_of(teach, "goggles", 6)
    press(teach, "Mirror wave 1")
    teach.get_by_text("mirrored").first.wait_for()
    press(teach, "Delete wave 4")
    examples_of(teach, "wave", 3)
    assert [each["label"] for each in room.teacher.examples()].count("wave") == 3


def test_a_take_in_which_nobody_moves_says_that_it_does_not_count_and_is_not_green(room: Lesson, teach: Any) -> None:
    fill_in(teach, "swing", "carla", 5)
    press(teach, "Record")
    says(teach, "record", "0 of 5")
    room.see(Stream().then(rest(12)).skeletons(noise_m=0.008, first_ns=10**12))
    press(teach, "Stop")
    said = teach.get_by_text("this take of swing does not count")
    said.wait_for()
    assert "refused" in said.get_attribute("class")
    says(teach, "record", "the movement was no larger than the noise of standing still: move further")
    examples_of(teach, "swing", 0)


def test_the_last_take_is_redone(room: Lesson, teach: Any) -> None:
    before = {each["id"] for each in room.teacher.examples() if each["label"] == "goggles"}
    press(teach, "Redo the last take")
    says(teach, "record", "0 of 5")
    room.see(Stream().repeat(GOGGLINGS).then(rest(4)).skeletons(first_ns=10**12))
    wait_until(lambda: not before & {each["id"] for each in room.teacher.examples()}, "the old take has gone")
    examples_of(teach, "goggles", 5)


def test_an_action_and_a_set_are_deleted_once_that_is_confirmed(room: Lesson, teach: Any) -> None:
    press(teach, "Delete all examples of wave")
    press(teach, "Keep", teach.get_by_role("dialog", name="Delete 5 examples of wave?"))
    press(teach, "Delete all examples of wave")
    press(teach, "Delete all", teach.get_by_role("dialog"))
    examples_of(teach, "wave", 0)
    press(teach, "Delete set")
    press(teach, "Delete set", teach.get_by_role("dialog", name=f"Delete the set {SET} with 5 examples?"))
    teach.get_by_text("Create a set first.").wait_for()
    assert room.teacher.ask("list")["sets"] == []


def test_sets_are_made_chosen_and_renamed(room: Lesson, teach: Any) -> None:
    teach.get_by_role("textbox", name="Name of a new set").fill("Küche 2")
    press(teach, "Create set")
    choice = teach.get_by_role("combobox", name="Set", exact=True).locator("visible=true")
    wait_until(lambda: choice.input_value() == "Küche 2", "the new set is chosen")
    press(teach, "Rename")
    teach.get_by_role("dialog").get_by_role("combobox", name="New name").fill("Garten")
    teach.keyboard.press("Enter")
    wait_until(lambda: choice.input_value() == "Garten", "its new name is shown")
    choice.select_option(SET)
    examples_of(teach, "wave", 5)


def test_the_simulated_person_is_asked_where_one_takes_requests(room: Lesson, teach: Any) -> None:
    fill_in(teach, "lift", "carla", 4)
    press(teach, "Record")
    press(teach, "Have the simulated person do it")
    says(teach, "record", "on its way")
    performed = room.page.colleague.performed
    assert performed == [{"actions": ["lift"] * 4, "object_id": 1}]


@pytest.mark.parametrize("way", ["dropped", "chosen"])
def test_a_video_is_sent_whole_and_read_as_a_job(room: Lesson, teach: Any, tmp_path: Path, way: str) -> None:
    clip = tmp_path / "wave 2.mp4"
    clip.write_bytes(bytes(range(256)) * 5000)
    if way == "chosen":
        teach.get_by_label("Drop a video anywhere").set_input_files(clip)
    else:
        drop(teach, clip.name, 5000)
    wait_until(lambda: bool(room.teacher.jobs), "it is imported")
    arguments = room.teacher.jobs[0].arguments
    assert arguments.video.read_bytes() == clip.read_bytes()
    assert (arguments.label, arguments.count) == ("wave", 5)
    room.teacher.jobs[0].news = Progressing("finding the person", 0.4)
    says(teach, "video", "Reading the video: finding the person, 40 %")
    room.end_job(None, "wave 2.mp4 is no video")
    says(teach, "video", "Failed: wave 2.mp4 is no video")


def test_what_went_wrong_with_one_of_several_videos_stays_while_the_next_ones_are_read(
    room: Lesson, teach: Any, tmp_path: Path
) -> None:
    clips = [tmp_path / name for name in ("wave 1.mp4", "a!.mp4", "wave 2.mp4", "wave 3.mp4")]
    for clip in clips:
        clip.write_bytes(b"x")
    teach.get_by_label("Drop a video anywhere").set_input_files(clips)
    wait_until(lambda: len(room.teacher.jobs) == 1, "the first is imported")
    room.end_job(None, "the video shows no person who moves")
    wait_until(lambda: len(room.teacher.jobs) == 2, "the third is imported, as the second is refused", 10)
    room.end_job(None, "no video")
    wait_until(lambda: len(room.teacher.jobs) == 3, "the last is imported", 10)
    before = teach.get_by_role("list", name="Videos before this one").get_by_role("listitem").all_text_contents()
    assert [text.partition(":")[0] for text in before] == ["wave 1.mp4", "a!.mp4", "wave 2.mp4"]
    assert "the video shows no person who moves" in before[0] and "'a!' cannot be a name" in before[1]


DROP = """([name, rounds]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([new Uint8Array(256 * rounds).map((_, i) => i % 256)], name));
  for (const type of ["dragover", "drop"]) {
    document.body.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
  }
}"""


def test_two_tabs_send_files_of_one_name_beside_each_other(room: Lesson, teach: Any, tmp_path: Path) -> None:
    other = teach.context.new_page()
    other.goto(teach.url)
    for page, content in ((teach, b"one"), (other, b"another")):
        (tmp_path / "wave.mp4").write_bytes(content)
        page.get_by_label("Drop a video anywhere").set_input_files(tmp_path / "wave.mp4")
        says(page, "video", "wave.mp4 sent.")
    files = room.teacher.folder.rglob("*-wave.mp4")  # one lies in the folder of the job that imports it
    assert {file.read_bytes() for file in files} == {b"one", b"another"}


def drop(page: Any, name: str, rounds: int) -> None:
    """Drop a file with the bytes 0 to 255, so many times, on the page."""
    page.evaluate(DROP, [name, rounds])


def trained(held_out: float = 0.9) -> dict[str, Any]:
    return {
        "model": tiny_model().id,
        "scores": {"accuracy_held_out": held_out},
        "left_out": [],
        "advice": [f"The model confuses {MARKUP} and wave: record 3 more examples of each."],
    }


def test_a_model_is_trained_put_into_use_compared_undone_and_deleted(room: Lesson, models: Any) -> None:
    models.get_by_label("Also learn how postures go on").check()
    press(models, "Train")
    wait_until(lambda: bool(room.teacher.jobs), "it is trained")
    assert room.teacher.jobs[0].arguments.continued
    room.teacher.jobs[0].news = Progressing("training the maps", 0.25)
    says(models, "training", "Training: training the maps, 25 %")
    room.end_job(trained())
    says(models, "training", "90 % of the examples recognised correctly, each by a model trained without it.")
    says(models, "training", f"The model confuses {MARKUP} and wave: record 3 more examples of each.")
    assert models.locator("#training img").count() == 0
    press(models, "Use this model")
    name = tiny_model().id[:8]
    row = models.get_by_role("row", name=name)
    row.get_by_text("in use").wait_for()
    assert room.teacher.model.exists()
    assert models.get_by_role("button", name="Back to the previous model").is_disabled()
    says(models, "model-list", f"In use: model {name}, trained on the set {SET}.")


def held_back(frames: Sequence[Skeleton], from_s: int, agent: int = 1) -> HeldBack:
    """Two seconds of these frames that are like a wave, but not like enough."""
    start_ns, end_ns = (frames[0].stamp_ns + seconds * SECOND_NS for seconds in (from_s, from_s + 2))
    return HeldBack(
        stamp_ns=end_ns, sensor="kinect0", agent=agent, start_ns=start_ns, end_ns=end_ns, action="wave",
        confidence=0.8, familiarity=0.31, why="unknown", sentence=f"like wave, but not like enough: 0.{from_s}",
    )  # fmt: skip


def test_what_was_held_back_is_corrected_by_one_click_each_and_the_model_made_anew(room: Lesson, models: Any) -> None:
    press(models, "Train")
    wait_until(lambda: bool(room.teacher.jobs), "it is trained")
    room.end_job(trained())
    press(models, "Use this model")
    says(models, "model-list", "In use: model")
    frames = Stream().repeat(WAVES).skeletons(first_ns=1_700_000_000 * SECOND_NS)
    room.see(frames)
    room.teacher.passed_ns += SECOND_NS
    go_to(models, "live")
    for from_s, really, kept in ((1, "It was wave", "an example of wave"), (4, "None of the actions", "none of the")):
        room.page.give(held_back(frames, from_s))
        models.get_by_role("button", name=f"like wave, but not like enough: 0.{from_s}, not told").click()
        says(models, "explanation", f"Not told: like wave, but not like enough: 0.{from_s}")
        press(models, really)
        says(models, "explanation", f"Kept in the set {SET} as {kept}")
    assert Counter(each["label"] for each in room.teacher.examples(SET)) == {"wave": 6, "goggles": 5, NONE: 1}
    go_to(models, "models")
    models.reload()
    says(models, "model-list", "In use: model")
    go_to(models, "live")
    room.page.give(frames[-1], held_back(frames, 7))
    models.get_by_role("button", name="like wave, but not like enough: 0.7, not told").click()
    press(models, "Update the model (2 corrections)")
    wait_until(lambda: len(room.teacher.jobs) == 2, "it is updated")
    [model] = room.teacher.ask("list")["models"]
    assert room.teacher.jobs[-1].arguments.model.name == f"{model['id']}.npz"
    room.end_job(trained())
    says(models, "explanation", "The new model is in use within two seconds.")
    models.get_by_role("button", name="Update the model").wait_for(state="hidden")


def test_a_correction_that_is_refused_is_told(room: Lesson, models: Any) -> None:
    press(models, "Train")
    wait_until(lambda: bool(room.teacher.jobs), "it is trained")
    room.end_job(trained())
    press(models, "Use this model")
    says(models, "model-list", "In use: model")
    frames = Stream().repeat(WAVES[:1]).skeletons(first_ns=1_700_000_000 * SECOND_NS)
    room.see(frames)
    go_to(models, "live")
    room.page.give(held_back(frames, 1, agent=2))
    models.get_by_role("button", name="like wave, but not like enough: 0.1, not told").click()
    press(models, "None of the actions")
    says(models, "explanation", "because only 0 frames of person 2 are still stored")


def test_a_model_that_somebody_named_is_said_to_be_only_read(room: Lesson, models: Any) -> None:
    says(models, "model-list", "No model is in use.")
    room.teacher.original.parent.mkdir()
    tiny_model().save(room.teacher.original)
    says(models, "model-list", f"In use: {room.teacher.original}. This file is only read")


def test_a_job_is_cancelled(room: Lesson, models: Any) -> None:
    press(models, "Train")
    wait_until(lambda: bool(room.teacher.jobs), "it is trained")
    room.teacher.jobs[0].news = Progressing("training the maps", 0.25)
    press(models, "Cancel")
    says(models, "training", "cancelled")
    assert room.teacher.jobs[0].ended


def test_a_confusion_matrix_is_a_table_that_is_read_by_row_and_column(room: Lesson, models: Any) -> None:
    press(models, "Test")
    wait_until(lambda: bool(room.teacher.jobs), "it is tested")
    room.end_job(
        {
            "by": "people", "accuracy": 0.9, "n": 10, "labels": ["goggles", "wave"], "confusion": [[5, 0], [1, 4]],
            "false_alarms_per_min": 1.25, "found": {"recall": 0.8}, "advice": ["Record 33 s more of background."],
        }
    )  # fmt: skip
    table = models.get_by_role("table", name="How often each action (row) was recognised as which (column)")
    table.wait_for()
    wave = table.get_by_role("row").filter(has=models.get_by_role("rowheader", name="wave", exact=True))
    assert wave.get_by_role("cell").all_text_contents() == ["120 %", "480 %"]
    assert table.get_by_role("columnheader").all_text_contents()[1:] == ["goggles", "wave"]
    says(models, "testing", "1.3")
    says(models, "testing", "Record 33 s more of background.")


def test_parameters_have_range_unit_and_default_and_a_refusal_stands_beside_them(room: Lesson, open_page: Open) -> None:
    page = open_page(f"{room.page.address}#parameters")
    reach = page.get_by_role("textbox", name="reach limit")
    reach.wait_for()
    assert reach.input_value() == "10"
    says(page, "parameters-pose_preprocessor", "more than 0 to 1000 · default: 10")
    reach.fill("-3")
    reach.press("Enter")
    says(
        page,
        "parameters-pose_preprocessor",
        "Refused: reach_limit_m should be greater than 0. The value is still 10.",
    )
    reach.fill("<b>x</b>")
    reach.press("Enter")
    says(page, "parameters-pose_preprocessor", "<b>x</b> is not a valid number.")
    reach.fill("7.5")
    reach.press("Enter")
    says(page, "parameters-pose_preprocessor", "set")
    page.reload()
    wait_until(lambda: reach.is_visible() and reach.input_value() == "7.5", "the service keeps it")
    press(page, "Default of reach_limit_m of pose_preprocessor")
    wait_until(lambda: reach.input_value() == "10", "the default is back")


NO_NAMES = {
    MARKUP: "cannot be a name",
    "x" * 300: "at most 256 characters",
    "../../etc": "cannot be a name",
    "x" * 10_000_000: "too long: at most 1000000 bytes",
    "a/b": "cannot be a name",
    "": "the name is empty",
}
"""Each with what is said of it, which differs from what was said of the one before."""


def test_names_that_are_none_are_refused_and_that_is_shown(room: Lesson, teach: Any) -> None:
    for name, said in NO_NAMES.items():
        teach.get_by_role("textbox", name="Name of a new set").evaluate(SET_VALUE, name)
        press(teach, "Create set")
        says(teach, "set", said)
        teach.get_by_role("combobox", name="Action").locator("visible=true").evaluate(SET_VALUE, name)
        press(teach, "Record")
        says(teach, "record", said if name else "the action has no name")
        assert teach.locator("#set img, #record img").count() == 0
    assert [each["name"] for each in room.teacher.ask("list")["sets"]] == [SET]


def test_what_is_no_name_in_a_file_dropped_is_replaced(room: Lesson, teach: Any) -> None:
    drop(teach, f"../{MARKUP}.mp4", 1)
    wait_until(lambda: any(sent(room)), "it is sent")
    (name,) = [path.name for path in sent(room)]
    assert re.fullmatch(r"\w+-img src_x onerror_alert_1__\.mp4", name)
    says(teach, "video", "cannot be a name")


def sent(room: Lesson) -> list[Path]:
    return sorted(room.teacher.folder.glob("uploads/.sent/*/[!.]*"))


def test_a_page_whose_trainer_is_silent_says_so(open_page: Open, scene: Any) -> None:
    page = open_page(f"{scene.page.address}#teach")
    page.get_by_role("status").filter(has_text="The service model_trainer does not answer").wait_for()


@pytest.mark.parametrize("phone", [False, True], ids=["wide", "phone"])
def test_no_panel_has_a_serious_fault_of_accessibility(room: Lesson, open_page: Open, phone: bool) -> None:
    size = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True} if phone else {}
    page = open_page(f"{room.page.address}#teach", **size)
    shown = {"teach": "Film of goggles 5", "models": "Confusion matrix", "parameters": "Default of bone_limit_m"}
    for panel, label in shown.items():
        go_to(page, panel)
        if panel == "models":
            page.get_by_role("row", name=SET).wait_for()
            press(page, "Test")
            wait_until(lambda: bool(room.teacher.jobs), "it is tested")
            result = {"by": "people", "accuracy": 1.0, "n": 2, "labels": ["a", "b"], "confusion": [[1, 0], [0, 1]]}
            room.end_job({**result, "false_alarms_per_min": None, "found": None, "advice": ["Record more."]})
        page.get_by_label(label).first.wait_for()
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert serious_faults(page) == [], (panel, scheme)
        assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth"), "nothing to scroll sideways"
        assert unnamed(page) == [], panel


UNNAMED = """() => {
  const nameOf = (it) => it.ariaLabel || it.labels?.[0]?.textContent || it.textContent;
  const controls = [...document.querySelectorAll("button, input, select, a[href], summary")];
  return controls.filter((it) => it.offsetParent && (it.tabIndex < 0 || !nameOf(it).trim())).map((it) => it.outerHTML);
}"""


def unnamed(page: Any) -> list[str]:
    """List the controls that have no name, or cannot be reached by the keyboard."""
    return list(page.evaluate(UNNAMED))
