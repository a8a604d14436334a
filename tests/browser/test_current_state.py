"""What the page shows holds now: what has ended, gone or been switched off is no longer shown, or said to be so."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

from actum.commands import Refusal
from actum.messages import Info, Objects, Segment
from dashboards import Colleague, served
from lessons import SET, Lesson
from live import wait_until
from page_scenes import Scene, status
from people import STANDING, skeleton
from repeating import Stream, rest
from teaching import WAVES, Teacher

pytestmark = pytest.mark.browser
Open = Callable[..., Any]
T_NS = 1_700_000_000_000_000_000
GREY = "([name]) => getComputedStyle(document.querySelector(name)).filter !== 'none'"


class Classifier(Colleague):
    """A classifier whose setting `segments` can be read and changed, in the place of a whole system."""

    def __init__(self) -> None:
        super().__init__(self._asked)
        self.segments = "auto"

    def infos(self) -> list[Any]:
        return [
            Info(
                stamp_ns=1, sensor="kinect0", service="som_classifier", instance="x", version="1", schemas=[],
                joint_names=[], commands=["parameters", "set_parameters"],
            )
        ]  # fmt: skip

    def _asked(self, _service: str, command: str, **fields: Any) -> dict[str, Any]:
        if command == "maps":
            raise Refusal("no model")
        if command == "set_parameters":
            self.segments = fields["values"]["segments"]
        return {"parameters": [{"name": "segments", "value": self.segments}]}


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two sets, of which one has an action."""
    teacher = Teacher(tmp_path_factory.mktemp("taught"))
    teacher.ask("create_set", set=SET)
    teacher.teach("wave", WAVES)
    teacher.ask("create_set", set="garden")
    return teacher.folder


@pytest.fixture
def teach(room: Lesson, open_page: Open) -> Any:
    page = open_page(f"{room.page.address}#teach")
    choose(page, SET)
    page.get_by_role("region", name="Examples of wave").wait_for()
    return page


def choose(page: Any, name: str) -> None:
    page.get_by_role("combobox", name="Set", exact=True).locator("visible=true").select_option(name)


def press(page: Any, name: str, within: Any = None) -> None:
    (within or page).get_by_role("button", name=name, exact=True).locator("visible=true").click()


def record(page: Any, label: str, count: int) -> None:
    page.get_by_role("combobox", name="Action").locator("visible=true").fill(label)
    page.get_by_role("combobox", name="Person").fill("carla")
    page.get_by_role("spinbutton", name="How many times").fill(str(count))
    press(page, "Record")
    page.locator("#record").get_by_text(f"0 of {count}").first.wait_for()


def test_where_marks_are_off_the_switch_is_grey_says_why_and_turns_them_on(open_page: Open) -> None:
    colleague = Classifier()
    with served(colleague) as served_page:
        page = open_page(served_page.address)
        switch = page.locator("#switch")
        switch.get_by_text("Marks are off: the classifier answers only the actions that it finds").wait_for()
        hold = switch.get_by_role("button", name="Hold to mark")
        assert hold.is_disabled()
        page.keyboard.press(" ")
        hold.click(force=True)
        assert [mark for mark in colleague.put_messages if isinstance(mark, Segment)] == []
        press(page, "Turn marks on", switch)
        switch.get_by_text("Hold the switch or the space bar").wait_for()
        assert (colleague.segments, hold.is_enabled()) == ("both", True)
        colleague.segments = "auto"
        wait_until(hold.is_disabled, "somebody else has turned them off")
        colleague.segments = "marks"
        wait_until(hold.is_enabled, "and on again")


def test_a_take_is_marked_by_hand_also_where_the_classifier_uses_no_marks(room: Lesson, teach: Any) -> None:
    teach.evaluate(
        """async () => {
          const { link } = await import('/page/link.js');
          const asked = link.ask.bind(link);
          link.ask = (service, command, fields) => service === 'som_classifier'
            ? Promise.resolve({ parameters: [{ name: 'segments', value: 'auto' }] }) : asked(service, command, fields);
          link.tell('info', { service: 'som_classifier', commands: ['parameters'] });
        }"""
    )
    record(teach, "swing", 1)
    hold = teach.locator("#take-switch").get_by_role("button", name="Hold to mark")
    assert hold.is_enabled()
    press(teach, "Discard")
    teach.evaluate("() => { location.hash = 'live' }")
    teach.locator("#switch").get_by_text("Marks are off").wait_for()


def bones(page: Any) -> int:
    """Count the pixels of the 3-D view in the colours of limbs."""
    picture = Picture.open(BytesIO(page.locator(".scene").screenshot())).convert("RGB")
    return sum(number for number, rgb in picture.getcolors(1 << 24) if max(rgb) - min(rgb) > 60)


def test_nobody_is_drawn_in_3d_after_everybody_has_left_or_the_sensor_has_stopped(open_in_3d: Open) -> None:
    with served(Classifier()) as served_page:
        page = open_in_3d(served_page.address)
        stamps_ns = iter(range(T_NS, 2 * T_NS, 33_000_000))

        def give_until(text: str, *bodies: Any) -> None:
            def given() -> bool:
                stamp_ns = next(stamps_ns)
                served_page.give(skeleton(stamp_ns, *bodies), Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=[]))
                return text in page.locator(".counts").text_content()

            wait_until(given, text)

        give_until("1 person · ", STANDING)
        wait_until(lambda: bones(page) > 200, "somebody is drawn")
        give_until("Nobody is seen · ")
        wait_until(lambda: bones(page) == 0, "nobody is drawn")
        give_until("1 person · ", STANDING)
        page.locator(".counts", has_text="Nobody is seen").wait_for()
        wait_until(lambda: bones(page) == 0, "nobody is drawn once no skeletons come")


def test_a_video_that_has_ended_greys_out_the_live_panel_alone(open_page: Open) -> None:
    with served(Classifier()) as served_page:
        page = open_page(f"{served_page.address}#teach")

        def ended() -> bool:
            served_page.give(status("sensor_gateway", T_NS).model_copy(update={"state": "source ended"}))
            return "The video or recording has ended" in page.locator("#state").text_content()

        wait_until(ended, "it says so")
        assert [page.evaluate(GREY, [panel]) for panel in ("#teach", "#models", "#live")] == [False, False, True]
        served_page.colleague.router = False
        page.locator("#state", has_text="Waiting for the router").wait_for()
        assert page.evaluate(GREY, ["#teach"])


def test_a_sensor_that_pauses_during_a_take_is_said_to_pause(room: Lesson, teach: Any) -> None:
    record(teach, "swing", 5)
    frames = Stream().then(rest(1)).repeat(WAVES[:1]).skeletons(first_ns=10**12)
    room.see(frames[: len(frames) - 45])  # it pauses in the middle of a movement
    phase = teach.locator("#record .phase")
    phase.get_by_text("The sensor publishes nothing: the take waits for it").wait_for(timeout=10_000)


def test_what_changed_while_no_trainer_ran_is_shown_once_one_does(room: Lesson, teach: Any) -> None:
    teach.locator("#set").get_by_text("wave × 5").wait_for()
    room.teacher.begin()
    teach.locator("#set").get_by_text("wave × 5").wait_for()
    (room.teacher.folder / f"sets/{SET}/take-0001.mcap").unlink()
    room.teacher.begin()
    teach.locator("#examples").get_by_text("No examples yet").wait_for()
    teach.locator("#set").get_by_text("No examples yet").wait_for()


def test_what_ended_without_this_page_is_told(room: Lesson, teach: Any) -> None:
    record(teach, "swing", 3)
    room.teacher.ask("discard")
    teach.locator("#record").get_by_text("This take was not kept: it was discarded on another page").wait_for()
    teach.evaluate("() => { location.hash = 'models' }")
    press(teach, "Train")
    wait_until(lambda: bool(room.teacher.jobs), "it is trained")
    room.teacher.begin()
    teach.locator("#training").get_by_text("Cancelled: the service ended while this job ran").wait_for()


def test_the_postures_of_people_who_have_gone_take_no_memory(scene: Scene, open_page: Open) -> None:
    kept = open_page(scene.page.address).evaluate("""async () => {
      const { link } = await import('/page/link.js');
      const { newestPosture } = await import('/page/live/people.js');
      const agents = Array.from({ length: 1000 }, (_, i) => 10_000 + i);
      for (const agent of agents) link.tell("posture", { agent });
      return agents.filter(newestPosture);
    }""")
    assert len(kept) < 100 and kept[-1] == 10_999


def test_examples_that_are_shown_no_more_take_no_memory(room: Lesson, teach: Any) -> None:
    devtools = teach.context.new_cdp_session(teach)
    nodes = []
    for _ in range(6):
        choose(teach, "garden")
        teach.locator("#examples").get_by_text("No examples yet").wait_for()
        choose(teach, SET)
        teach.locator(".example canvas.film").last.wait_for()
        devtools.send("HeapProfiler.collectGarbage")
        nodes.append(devtools.send("Memory.getDOMCounters")["nodes"])
    of_examples = teach.locator(".example *").count()
    assert nodes[-1] - nodes[1] < 2 * of_examples, nodes


def test_what_was_said_of_a_set_is_gone_once_another_is_shown(room: Lesson, teach: Any) -> None:
    record(teach, "swing", 3)
    room.see(Stream().repeat(WAVES[:2]).then(rest(1)).skeletons(first_ns=10**12))
    press(teach, "Stop")
    doubts = teach.locator("#record .doubts li")
    doubts.first.wait_for()
    press(teach, "Delete all examples of wave")
    press(teach, "Delete all", teach.get_by_role("dialog"))
    teach.locator("#examples").get_by_text("All examples of wave deleted.").wait_for()
    choose(teach, "garden")
    teach.get_by_text("No examples yet: record an action").wait_for()
    assert doubts.count() == 0
    assert {line.text_content() for line in teach.locator("#teach .outcome").all()} == {""}


def test_a_set_that_is_deleted_is_named_and_what_was_said_of_its_test_is_gone(room: Lesson, open_page: Open) -> None:
    page = open_page(f"{room.page.address}#models")
    choice = page.get_by_role("combobox", name="Set to test")
    choice.select_option(SET)
    press(page, "Test")
    wait_until(lambda: bool(room.teacher.jobs), "it is tested")
    result = {"by": "people", "accuracy": 1.0, "n": 1, "labels": ["a", "b"], "confusion": [[1, 0], [0, 0]]}
    room.end_job({**result, "false_alarms_per_min": None, "found": None, "advice": ["Record more."]})
    page.locator("#testing").get_by_text("of 1 example recognised, each person left out").first.wait_for()
    page.evaluate("() => { location.hash = 'teach' }")
    press(page, "Delete set")
    press(page, "Delete set", page.get_by_role("dialog"))
    page.locator("#set").get_by_text(f"Set {SET} deleted.").wait_for()
    page.evaluate("() => { location.hash = 'models' }")
    assert page.locator("#testing .facts, #testing table").count() == 0


def test_every_panel_shows_the_take_that_is_recorded_and_leads_to_it(room: Lesson, teach: Any) -> None:
    record(teach, "swing", 5)
    teach.evaluate("() => { location.hash = 'models' }")
    note = teach.get_by_role("link", name=f"Recording swing, 0 of 5 by carla into {SET}")
    note.click()
    press(teach, "Discard")
    note.wait_for(state="hidden")


def test_the_simulated_person_acts_outside_of_a_take(room: Lesson, teach: Any) -> None:
    teach.evaluate("() => { location.hash = 'live' }")
    card = teach.locator("#acting")
    card.get_by_role("combobox", name="What to do").select_option("lift")
    card.get_by_role("spinbutton", name="How often").fill("2")
    press(teach, "Do it", card)
    card.get_by_text("Requested: lift, 2 times.").wait_for()
    press(teach, "Everyday movements", card)
    card.get_by_text("s of everyday movements.").wait_for()
    assert room.page.colleague.performed == [{"actions": ["lift", "lift"]}, {"everyday_s": 20}]


def test_no_simulated_person_is_offered_where_none_takes_requests(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    page.locator("#state", has_text="live").wait_for()
    assert page.locator("#acting").is_hidden()
