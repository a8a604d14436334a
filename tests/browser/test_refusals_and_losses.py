"""What is refused, lost or wrong in one place ends nothing else: the page says so, and goes on."""

import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from actum.commands import Refusal
from actum.messages import Info, Segment
from actum.runtime.client import NotAnsweredError
from dashboards import Colleague, served
from lessons import SET, Lesson
from live import wait_until
from model_trainer.job_process import Ended
from node_cases import photograph
from page_scenes import Scene, maps
from teaching import WAVES, Teacher
from web_dashboard.encoding import text

pytestmark = pytest.mark.browser
Open = Callable[..., Any]
RESULT = {
    "by": "people", "accuracy": 0.9, "n": 10, "labels": ["a", "b"], "confusion": [[5, 0], [1, 4]],
    "false_alarms_per_min": 1.25, "found": None, "advice": [],
}  # fmt: skip


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which one action was taught."""
    teacher = Teacher(tmp_path_factory.mktemp("taught"))
    teacher.ask("create_set", set=SET)
    teacher.teach("wave", WAVES)
    return teacher.folder


def live(page: Any) -> Any:
    page.locator("#sensor", has_text="kinect0").wait_for()
    return page


def hasten(page: Any, module: str, usual: str, quick: str) -> None:
    """Have a page wait for less."""

    def changed(route: Any) -> None:
        served_as = route.fetch()
        assert usual in served_as.text()
        route.fulfill(response=served_as, body=served_as.text().replace(usual, quick))

    page.route(f"**/page/{module}", changed)


def refuse_first(colleague: Colleague, *commands: str) -> None:
    """Have nobody answer these commands when they are asked for the first time."""
    first, answer = set(commands), colleague.answer

    def asked(service: str, command: str, **fields: Any) -> dict[str, Any]:
        if command in first:
            first.remove(command)
            raise NotAnsweredError(f"{service} does not answer")
        return answer(service, command, **fields)

    colleague.answer = asked


def settled(page: Any, ask: str) -> str:
    """Say what becomes of an order, at the latest after five seconds."""
    return str(
        page.evaluate(
            f"""async () => {{
              const {{ link }} = await import('/page/link.js');
              const late = new Promise((resolve) => setTimeout(() => resolve('pending'), 5000));
              return Promise.race([late, {ask}.then(() => 'answered', (error) => error.message)]);
            }}"""
        )
    )


def test_orders_end_with_the_connection_the_refusal_of_none_and_the_longest_wait(open_page: Open) -> None:
    never = threading.Event()
    with served(Colleague(lambda *_, **__: {"done": never.wait(20)})) as served_page:
        page = open_page("about:blank")
        hasten(page, "link.js", "ANSWER_MS = 60_000", "ANSWER_MS = 2_000")
        page.goto(served_page.address)
        ask = "link.ask('som_classifier', 'wait')"
        assert "no answer came within 2 s" in settled(live(page), ask)
        online = f"(setTimeout(() => dispatchEvent(new Event('online')), 200), {ask})"
        assert "connection was lost" in settled(page, online)
        page.wait_for_function("async () => (await import('/page/link.js')).link.state.connected")
        unnumbered = text(id=None, error="no order at all")
        refuse = f"(setTimeout(() => link.socket.onmessage({{ data: {unnumbered!r} }}), 200), {ask})"
        assert settled(page, refuse) == "no order at all"
        never.set()


@pytest.fixture
def flawed(room: Lesson, chromium: Any) -> Iterator[Any]:
    """A page in which a test makes bugs: all of them are to be in the console."""
    context = chromium.new_context()
    page, said = context.new_page(), []
    page.on("console", lambda each: said.append(each.text))
    page.goto(f"{room.page.address}#teach")
    page.get_by_role("img", name="Film of wave 1", exact=True).scroll_into_view_if_needed()
    yield page
    assert any("a bug in the page: Error: made by a test" in each for each in said)
    context.close()


def test_a_listener_that_throws_keeps_no_other_from_being_called(flawed: Any) -> None:
    flawed.evaluate(
        """async () => {
          const { link } = await import('/page/link.js');
          window.heard = 0;
          link.on('training', () => { throw new Error('made by a test'); });
          link.on('training', () => heard++);
        }"""
    )
    flawed.wait_for_function("() => heard > 3", timeout=5000)


def test_a_film_that_throws_stops_no_other(flawed: Any) -> None:
    flawed.evaluate(
        """async () => {
          const { Film } = await import('/page/teach/film.js');
          const film = new Film(document.body.appendChild(document.createElement('canvas')));
          window.broken = new Promise((resolve) => {
            film.step = () => {
              resolve();
              throw new Error('made by a test');
            };
          });
          await broken;
        }"""
    )
    film = flawed.get_by_role("img", name="Film of wave 1", exact=True)
    flawed.wait_for_timeout(100)
    before = film.screenshot()
    wait_until(lambda: film.screenshot() != before, "the other films go on", 5)


def test_a_result_whose_showing_throws_is_shown_once_and_is_no_refusal(room: Lesson, flawed: Any) -> None:
    flawed.evaluate(
        """async () => {
          const { JobView } = await import('/page/jobs.js');
          window.ended = 0;
          const view = new JobView(['evaluate'], () => {
            ended++;
            throw new Error('made by a test');
          });
          view.element.id = 'view';
          document.body.append(view.element);
        }"""
    )
    room.teacher.ask("evaluate", set=SET)
    room.end_job(RESULT)
    flawed.wait_for_function("() => ended > 0")
    flawed.wait_for_timeout(200)
    assert (flawed.evaluate("() => ended"), flawed.locator("#view .refused").count()) == (1, 0)


def test_a_video_goes_on_where_another_job_came_after_the_one_before_unseen(
    room: Lesson, open_page: Open, tmp_path: Path
) -> None:
    page = live(open_page(f"{room.page.address}#teach"))
    page.get_by_role("region", name="Examples of wave").wait_for()
    clips = [tmp_path / "one.mp4", tmp_path / "two.mp4"]
    for clip in clips:
        clip.write_bytes(b"x")
    page.get_by_label("Drop a video anywhere").set_input_files(clips)
    wait_until(lambda: len(room.teacher.jobs) == 1, "the first is imported")
    page.get_by_text("Reading the video: ").wait_for()
    with room._lock:
        room.teacher.jobs[0].news = Ended(None, "one.mp4 is no video")
        room.teacher.tick(1)
        room.teacher.ask("evaluate", set=SET)
        room.teacher.jobs[1].news = Ended(RESULT, "")
        room.teacher.tick(1)
    wait_until(lambda: len(room.teacher.jobs) == 3, "the second is imported", 10)
    assert room.teacher.jobs[2].arguments.kind == "import"


def test_what_a_busy_service_did_not_answer_is_asked_for_again(room: Lesson, open_page: Open) -> None:
    refuse_first(room.page.colleague, "examples", "film", "parameters")
    page = open_page(f"{room.page.address}#teach")
    examples = page.locator("#examples")
    examples.get_by_text("no film: model_trainer does not answer").wait_for()
    wait_until(lambda: examples.get_by_text("does not answer").count() == 0, "all of it is there", 10)
    page.evaluate("() => { location.hash = 'parameters' }")
    reach = page.get_by_role("textbox", name="reach limit")
    reach.wait_for(timeout=10_000)
    refuse_first(room.page.colleague, "set_parameters")
    reach.fill("7.5")
    reach.press("Enter")
    page.get_by_text("The value may not be set: pose_preprocessor").wait_for()


def test_a_value_that_is_being_typed_is_not_overwritten_by_one_that_is_read(room: Lesson, open_page: Open) -> None:
    page = open_page(f"{room.page.address}#parameters")
    reach, colleague = page.get_by_role("textbox", name="reach limit"), room.page.colleague
    wait_until(lambda: reach.count() == 1 and reach.input_value() == "10", "they are read")
    reach.fill("7.5")
    colleague.answer("pose_preprocessor", "set_parameters", values={"reach_limit_m": 8.0})
    page.evaluate("() => dispatchEvent(new HashChangeEvent('hashchange'))")
    reset = page.get_by_role("button", name="Default of reach_limit_m of pose_preprocessor")
    wait_until(reset.is_enabled, "they are read again")
    assert reach.input_value() == "7.5"
    reach.press("Enter")
    page.get_by_text("Set.").wait_for()
    assert reach.input_value() == "7.5"


def test_the_parameters_of_a_service_that_was_started_anew_are_read_anew(room: Lesson, open_page: Open) -> None:
    page = open_page(f"{room.page.address}#parameters")
    reach = page.get_by_role("textbox", name="reach limit")
    wait_until(lambda: reach.count() == 1 and reach.input_value() == "10", "they are read")
    colleague = room.page.colleague
    colleague.answer("pose_preprocessor", "set_parameters", values={"reach_limit_m": 7.5})
    infos = colleague.infos()
    colleague.infos = lambda: [info.model_copy(update={"instance": "y"}) for info in infos]
    wait_until(lambda: reach.input_value() == "7.5", "they are read anew", 10)


def test_a_picture_that_cannot_be_decoded_is_told_while_pictures_come(open_page: Open) -> None:
    with served(Colleague(maps)) as served_page:
        page = live(open_page(served_page.address))
        told = page.locator("#picture").get_by_text("The picture cannot be decoded.")
        good = photograph(1)

        def give_until(is_told: bool, **wrong: Any) -> None:
            def given() -> bool:
                served_page.give(good.model_copy(update=wrong))
                return bool(told.is_visible() == is_told)

            wait_until(given, f"told: {is_told}", 5)

        give_until(False)
        page.locator("#picture canvas").wait_for()
        give_until(True, format="jpeg", data=b"no JPEG")
        give_until(False)


def test_a_model_without_maps_is_asked_for_them_once_and_the_next_one_again(
    open_page: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("web_dashboard.application.DESCRIBING_S", 0.1)
    asked, running = [], ["without"]

    def classifier(service: str, command: str, **fields: Any) -> dict[str, Any]:
        asked.append(running[0])
        if running[0] == "without":
            raise Refusal("the model has no maps: models of kind 'other' contain none")
        return maps(service, command, **fields) | {"model": running[0], "action_map": None}

    colleague = Colleague(classifier)
    colleague.infos = lambda: [  # type: ignore[method-assign]
        Info(
            stamp_ns=1, sensor="kinect0", service="som_classifier", instance="x", version="1", schemas=[],
            joint_names=[], model=running[0],
        )
    ]  # fmt: skip
    with served(colleague) as served_page:
        page = open_page("about:blank")
        hasten(page, "live/maps.js", "ASK_MS = 4000", "ASK_MS = 100")
        page.goto(served_page.address)
        page.locator("#postures").get_by_text("the model has no maps").wait_for()
        page.wait_for_timeout(1000)
        assert len(asked) <= 2, "before and after the classifier has named its model"
        running[0] = "with"
        page.locator("#postures").get_by_text("Each figure is the posture").wait_for(timeout=10_000)
        page.wait_for_timeout(500)
        assert asked.count("with") == 1


def test_a_mark_without_an_answer_says_so_and_one_whose_connection_is_lost_ends(scene: Scene, open_page: Open) -> None:
    page = open_page("about:blank")
    hasten(page, "live/switch.js", "ANSWER_S = 6", "ANSWER_S = 1")
    page.goto(scene.page.address)
    live(page)
    caption = page.locator("#switch .caption")
    for _ in range(2):
        page.keyboard.press(" ")
        page.wait_for_timeout(100)
    caption.get_by_text("No answer within 1 s").wait_for(timeout=5000)
    page.keyboard.press(" ")
    marks = scene.page.colleague.put_messages
    wait_until(lambda: len(marks) == 3, "the start is marked")
    page.evaluate("() => dispatchEvent(new Event('online'))")
    caption.get_by_text("connection was lost").wait_for(timeout=5000)
    page.get_by_role("button", name="Hold to mark").wait_for()
    wait_until(lambda: [mark.kind for mark in marks if isinstance(mark, Segment)] == ["start", "end"] * 2, "it ends", 5)


def test_what_has_gone_when_a_button_is_pressed_is_told_in_words(room: Lesson, open_page: Open) -> None:
    answer = room.page.colleague.answer
    model = {
        "id": "0123456789ab", "created": "2026-01-01", "set": SET, "labels": ["a"], "people": [], "samples": 3,
        "active": False, "scores": {},
    }  # fmt: skip

    def asked(service: str, command: str, **fields: Any) -> dict[str, Any]:
        if command == "compare":
            return {"model": model, "added": [], "missing": [], "sentence": "alone"}
        reply = answer(service, command, **fields)
        return reply | {"models": [model]} if command == "list" else reply

    room.page.colleague.answer = asked
    page = live(open_page(f"{room.page.address}#models"))
    page.get_by_role("button", name="Compare model 01234567").click()
    page.locator("#model-list").get_by_text(
        "No model is in use, so there is nothing to compare this one with."
    ).wait_for()
    page.get_by_text("Have the simulated person do it").evaluate("it => it.click()")
    page.locator("#record").get_by_text("No take is being recorded: press Record first").wait_for(state="attached")
    page.evaluate(
        """async () => {
          const { trainer } = await import('/page/trainer.js');
          Object.defineProperty(trainer, 'set', { get: () => null });
          for (const button of document.querySelectorAll('#set button')) button.disabled || button.click();
        }"""
    )
    page.wait_for_timeout(200)
    assert page.get_by_role("dialog").count() == 0
