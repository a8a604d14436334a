"""The live view in a browser: it shows what goes on, says what it waits for, and can be used by everybody."""

import re
from collections.abc import Callable
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

from accessibility import serious_faults
from actum.messages import Segment
from actum.node import SECOND_NS
from live import wait_until
from page_scenes import Scene, action, wait_for_state

pytestmark = pytest.mark.browser
Open = Callable[..., Any]
FAINT, EDGES = 15, 0.005
"""Difference of brightness that is no noise, and share of pixels that differ where a body moves by a pixel."""
COLOURS = 100
"""An empty canvas has a few dozen: a gradient."""
HELD_MS = 500
"""Longer than a press that leaves the switch on."""


def colours(page: Any, selector: str) -> int:
    picture = Picture.open(BytesIO(page.locator(selector).screenshot())).convert("RGB")
    return len(picture.getcolors(1 << 24))


def at_rest(view: Any) -> bytes:
    """Wait until it no longer moves, and return its picture."""
    seen = [view.screenshot()]

    def rests() -> bool:
        seen.append(view.screenshot())
        return seen[-1] == seen[-2]

    wait_until(rests, "the view is at rest")
    return seen[-1]


def is_other(view: Any, before: bytes) -> bool:
    """Tell whether more is drawn elsewhere than the edges of what moves by a pixel."""
    then, now = (np.asarray(Picture.open(BytesIO(each)).convert("RGB"), float) for each in (before, view.screenshot()))
    return bool((np.abs(now - then).max(axis=2) > FAINT).mean() > EDGES)


def test_a_skeleton_moves(scene: Scene, open_in_3d: Open) -> None:
    page = open_in_3d(scene.page.address)
    wait_for_state(page, "live")
    page.wait_for_timeout(500)
    assert colours(page, ".scene") > COLOURS
    first = page.locator(".scene").screenshot()
    page.wait_for_timeout(400)
    assert page.locator(".scene").screenshot() != first
    assert page.locator(".counts").text_content() == "1 person · 1 of 1 object in sight"


@pytest.mark.long
def test_the_view_turns_zooms_and_changes_its_frame_by_keys(scene: Scene, open_in_3d: Open) -> None:
    page = open_in_3d(scene.page.address)
    wait_for_state(page, "live")
    scene.still = True
    view = page.get_by_role("group", name="3-D view")
    view.focus()
    before = at_rest(view)
    for key in ("ArrowLeft", "ArrowUp", "+"):
        page.keyboard.press(key)
        after = at_rest(view)
        assert after != before, key
        before = after
    page.get_by_label("Frame of the 3-D view").select_option("person")
    assert at_rest(view) != before


def test_who_moves_is_also_drawn_as_expected_in_half_a_second_unless_that_is_switched_off(
    scene: Scene, open_in_3d: Open
) -> None:
    page = open_in_3d(scene.page.address)
    wait_for_state(page, "live")
    scene.still = True
    scene.go_on(2.0)  # until the trails of the hands end
    view, ahead = page.get_by_role("group", name="3-D view"), page.get_by_label("Half a second ahead")
    alone = at_rest(view)
    scene.rise(0.4)
    wait_until(lambda: is_other(view, alone), "the ghost is drawn")
    ahead.uncheck()
    wait_until(lambda: not is_other(view, alone), "the ghost is switched off")
    ahead.check()
    wait_until(lambda: is_other(view, alone), "the ghost is switched on")
    scene.rise(None)
    wait_until(lambda: not is_other(view, alone), "the ghost goes where nothing is expected any more")


def test_an_event_appears_large_in_the_timeline_and_with_what_spoke_for_it(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    scene.answer("one", "push object 1 cup")
    page.locator("#now .action", has_text="push").wait_for()
    page.locator("#now .object", has_text="cup 1").wait_for()
    scene.go_on(2.0)
    scene.answer("two", "push object 1 cup again")
    button = page.get_by_role("button", name="push object 1 cup, ")
    button.click()
    page.locator("#explanation .sentence", has_text="push object 1 cup").wait_for()
    assert "wave is next, 0.70 behind" in page.locator("#explanation").text_content()
    assert page.locator("#neurons .winner .name").text_content() == "push"


def test_what_is_about_to_be_touched_is_grey_until_it_is_certain_and_goes_with_the_event(
    scene: Scene, open_page: Open
) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    line = page.locator("#now .ahead")
    assert not line.is_visible()
    scene.reach(0.6, 0.42)
    page.locator("#now .ahead:not(.certain)", has_text="→ cup, in 0.4 s").wait_for()
    scene.reach(0.93, 0.11)
    page.locator("#now .ahead.certain", has_text="→ cup, in 0.1 s").wait_for()
    scene.answer("one", "push object 1 cup")
    line.wait_for(state="hidden")
    scene.go_on(0.5)
    assert not line.is_visible()


@pytest.mark.parametrize("silently", [False, True], ids=["with an empty intent", "with the person lost from view"])
def test_what_is_about_to_be_touched_goes_when_the_reach_ends(silently: bool, scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    scene.reach(0.93, 0.2)
    page.locator("#now .ahead").wait_for()
    scene.end_reach(silently)
    page.locator("#now .ahead").wait_for(state="hidden")


def test_labels_with_markup_are_shown_as_they_are(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    scene.answer("bad", "<img src=x onerror=alert(1)> <b>cup</b>")
    page.locator("#explanation .sentence", has_text="<img src=x onerror=alert(1)> <b>cup</b>").wait_for()
    assert page.locator("#explanation img, #explanation b").count() == 0


def test_the_maps_are_drawn_and_the_way_over_them_moves(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    page.locator("#actions .key", has_text="wave").wait_for()
    page.wait_for_timeout(500)
    assert colours(page, "#postures canvas") > COLOURS
    assert colours(page, "#actions canvas") > 3


def test_each_service_has_its_row(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    row = page.locator("#health tr", has_text="som_classifier")
    row.locator("td", has_text="1.0 / 2.0 ms").wait_for()
    row.locator("summary").click()
    assert "skeleton 30" in row.locator("dl").text_content()


def test_below_the_services_stands_where_the_time_goes(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    hops = page.locator("#health .hops")
    assert hops.is_hidden(), "nothing has been measured"
    wait_until(lambda: "posture" in scene.measured(), "it is measured from which skeleton each posture follows")
    row = hops.locator("tr", has_text="skeleton → posture")
    row.get_by_text(re.compile(r"^\d+\.\d ms$")).first.wait_for()
    [p50, p99, count] = row.locator("td").all_text_contents()
    assert float(p50.removesuffix(" ms")) <= float(p99.removesuffix(" ms")) and int(count.removesuffix(" ×")) > 0


def hold_space(page: Any) -> None:
    page.keyboard.down(" ")
    page.get_by_role("button", name="Marking").wait_for()
    page.wait_for_timeout(HELD_MS)
    page.keyboard.up(" ")


def press_space_twice(page: Any) -> None:
    page.keyboard.press(" ")
    page.get_by_role("button", name="Marking").wait_for()
    page.keyboard.press(" ")


def hold_the_button(page: Any) -> None:
    page.get_by_role("button", name="Hold to mark").hover()
    page.mouse.down()
    page.get_by_role("button", name="Marking").wait_for()
    page.wait_for_timeout(HELD_MS)
    page.mouse.up()


def press_the_button_by_keyboard(page: Any) -> None:
    page.get_by_role("button", name="Hold to mark").focus()
    press_space_twice(page)


def test_the_switch_marks_start_and_end_whichever_way_it_is_used(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    marks = scene.page.colleague.put_messages
    for use in (hold_space, press_space_twice, hold_the_button, press_the_button_by_keyboard):
        marks.clear()
        use(page)
        page.locator("#switch .caption", has_text="waiting for the answer").wait_for()
        assert [mark.kind for mark in marks if isinstance(mark, Segment)] == ["start", "end"], use
        assert len({mark.segment_id for mark in marks}) == 1
        scene.answer(marks[0].segment_id, f"push {use.__name__}")
        page.locator("#switch .caption", has_text=f"Answer: push {use.__name__}").wait_for()


def test_a_name_that_a_source_uses_again_once_it_is_started_anew_is_of_another_segment(
    scene: Scene, open_page: Open
) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    scene.answer("one", "push object 1 cup")
    page.locator("#now .object", has_text="cup 1").wait_for()
    times = {"stamp_ns": scene.stamp_ns, "start_ns": scene.stamp_ns - SECOND_NS // 2, "end_ns": None}
    early = action("one", times, final=False).model_copy(update={"session_id": "anew", "action": "wave"})
    scene.page.give(early)
    page.locator("#now .kicker", has_text="So far it looks like").wait_for()


def test_a_mark_that_is_refused_is_told(scene: Scene, open_page: Open) -> None:
    scene.page.colleague.listened = False
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    page.keyboard.press(" ")
    page.locator("#switch .caption", has_text="Not marked: no service receives marks").wait_for()


def test_a_page_that_is_loaded_anew_shows_the_answers_before(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    scene.answer("one", "push object 1 cup")
    page.reload()
    page.get_by_role("button", name="push object 1 cup, ").wait_for()


def test_it_says_that_there_is_no_router_and_when_it_is_back(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    scene.page.colleague.router = False
    wait_for_state(page, "Waiting for the router at tcp/127.0.0.1:7447")
    scene.page.colleague.router = True
    wait_for_state(page, "live")


def test_a_network_that_falls_silent_is_noticed(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    page.context.set_offline(True)
    wait_for_state(page, "Waiting for")
    page.context.set_offline(False)
    wait_for_state(page, "live")


def test_a_dropped_connection_is_opened_again(scene: Scene, chromium: Any) -> None:
    context = chromium.new_context()
    page = context.new_page()
    connections = []

    def relay(socket: Any) -> None:
        socket.connect_to_server()
        connections.append(socket)

    page.route_web_socket("**/ws", relay)
    page.goto(scene.page.address)
    wait_for_state(page, "live")
    connections[0].close(code=1011)
    page.wait_for_function("() => document.getElementById('state').textContent !== 'live'")
    wait_for_state(page, "live")
    assert len(connections) == 2
    context.close()


def test_a_stalled_tab_costs_the_others_nothing_and_shows_the_newest_afterwards(scene: Scene, open_page: Open) -> None:
    stalled, other = open_page(scene.page.address), open_page(scene.page.address)
    for page in (stalled, other):
        wait_for_state(page, "live")
    debugger = stalled.context.new_cdp_session(stalled)
    debugger.send("Debugger.enable")
    debugger.send("Debugger.pause")
    scene.answer("one", "push object 1 cup")
    other.get_by_role("button", name="push object 1 cup, ").wait_for()
    other.wait_for_timeout(1500)
    assert other.locator("#state").text_content() == "live"
    debugger.send("Debugger.resume")
    stalled.get_by_role("button", name="push object 1 cup, ").wait_for()
    wait_for_state(stalled, "live")


@pytest.mark.parametrize("phone", [False, True], ids=["wide", "phone"])
def test_it_has_no_serious_fault_of_accessibility(scene: Scene, open_page: Open, phone: bool) -> None:
    size = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True} if phone else {}
    page = open_page(scene.page.address, **size)
    wait_for_state(page, "live")
    scene.answer("one", "push object 1 cup")
    page.get_by_role("button", name="push object 1 cup, ").wait_for()
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        assert serious_faults(page) == [], scheme
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth"), "nothing to scroll sideways"


def test_every_control_is_reached_by_the_tabulator_and_has_a_name(scene: Scene, open_in_3d: Open) -> None:
    page = open_in_3d(scene.page.address)
    wait_for_state(page, "live")
    scene.answer("one", "push object 1 cup")
    page.get_by_role("button", name="push object 1 cup, ").wait_for()
    reached = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("() => document.activeElement.ariaLabel ?? document.activeElement.textContent"))
    wanted = {
        "Frame of the 3-D view",
        "Hold to mark",
        "Whose action is marked",
        "Length of the timeline",
        "som_classifier",
    }
    assert wanted <= reached


def test_without_3d_it_says_so_and_shows_the_rest(scene: Scene, open_page: Open) -> None:
    page = open_page(scene.page.address)
    wait_for_state(page, "live")
    assert "cannot draw in 3-D" in page.locator("#scene").text_content()
    assert colours(page, "#picture canvas") > 2
