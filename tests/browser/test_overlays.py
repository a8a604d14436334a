"""What is drawn over the picture and in 3-D: of the same instant as the image, with labels that cover no other."""

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from actum.messages import Objects, TrackedObject
from dashboards import Colleague, Served, served
from live import wait_until
from node_cases import photograph
from page_scenes import maps
from people import STANDING, skeleton

pytestmark = pytest.mark.browser
Open = Callable[..., Any]
MS = 1_000_000
T_NS = 1_700_000_000_000_000_000
LEFT, RIGHT = np.array([-0.9, 0.0, 0.0]), np.array([0.9, 0.0, 0.0])
"""Ways to either side of the picture (m)."""
OBJECTS = ("cup", "box", "book", "bottle", "phone")
COLOURED = """() => {
  const canvas = document.querySelector("#picture canvas");
  if (!canvas.width) return [];
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const sides = { left: 0, right: 0 };
  for (let i = 0; i < data.length; i += 4) {
    const rgb = [data[i], data[i + 1], data[i + 2]];
    const isLeft = (i / 4) % canvas.width < canvas.width / 2;
    if (Math.max(...rgb) - Math.min(...rgb) > 60) sides[isLeft ? "left" : "right"]++;
  }
  return Object.keys(sides).filter((side) => sides[side] > 20);
}"""
"""On which sides of the picture, which is grey, something coloured is drawn: somebody's bones."""
HEAR = """async () => {
  const { link } = await import("/page/link.js");
  window.heard = {};
  for (const type of ["skeleton", "objects"]) link.on(type, ({ stamp_ns: stamp }) => (heard[type] = stamp));
}"""
"""Note the newest stamp of each stream, which the page's service passes on where several wait."""


@pytest.fixture
def page_service() -> Iterator[Served]:
    with served(Colleague(maps)) as made:
        yield made


def opened(open_it: Open, page_service: Served) -> Any:
    page = open_it(page_service.address)
    page.locator("#sensor", has_text="kinect0").wait_for()
    return page


def objects(stamp_ns: int, *places_m: tuple[float, float, float]) -> Objects:
    tracked = [
        TrackedObject(
            id=number, name=OBJECTS[number - 1], position_m=list(place), quaternion_xyzw=[0, 0, 0, 1], confidence=1.0,
            seen=True,
        )
        for number, place in enumerate(places_m, start=1)
    ]  # fmt: skip
    return Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=tracked)


def sides(page: Any) -> list[str]:
    return list(page.evaluate(COLOURED))


def boxes(page: Any, card: str) -> dict[str, dict[str, float]]:
    """Return where each label of a card is, by its text: of all at one instant, or one could move before the next."""
    placed: dict[str, dict[str, float]] = page.locator(f"#{card} .label").evaluate_all(
        "labels => Object.fromEntries(labels.map((it) => [it.textContent, it.getBoundingClientRect().toJSON()]))"
    )
    return placed


def covering(page: Any, card: str) -> list[tuple[str, str]]:
    """List the pairs of a card's labels of which one covers the other."""

    def overlap(one: dict[str, float], other: dict[str, float]) -> bool:
        across = min(one["x"] + one["width"], other["x"] + other["width"]) - max(one["x"], other["x"])
        down = min(one["y"] + one["height"], other["y"] + other["height"]) - max(one["y"], other["y"])
        return across > 1 and down > 1

    placed = boxes(page, card)
    return [(one, other) for one, other in combinations(placed, 2) if overlap(placed[one], placed[other])]


def test_an_image_waits_for_the_skeleton_and_the_objects_of_its_instant(page_service: Served, open_page: Open) -> None:
    page = opened(open_page, page_service)
    page.evaluate(HEAR)
    before_ns, after_ns = T_NS - 33 * MS, T_NS + 33 * MS
    for stamp_ns, way in ((before_ns, LEFT), (T_NS, RIGHT), (after_ns, LEFT)):
        if stamp_ns == T_NS:
            page_service.give(photograph(T_NS))
        page_service.give(skeleton(stamp_ns, STANDING + way), objects(stamp_ns, (way[0] / 2, 0.0, 2.0)))
        page.wait_for_function("stamp => heard.skeleton === stamp && heard.objects === stamp", arg=float(stamp_ns))
    wait_until(lambda: sides(page) == ["right"], "the image has its own skeleton, and neither neighbour's")
    middle = page.locator("#picture canvas").bounding_box()
    cup = boxes(page, "picture")["1 cup"]
    assert cup["x"] > middle["x"] + middle["width"] / 2


def test_what_is_more_than_50_ms_off_is_not_drawn_on_an_image(page_service: Served, open_page: Open) -> None:
    page = opened(open_page, page_service)
    off_ns = T_NS - 51 * MS
    page_service.give(photograph(T_NS), skeleton(off_ns, STANDING + LEFT), objects(off_ns, (-0.5, 0.0, 2.0)))
    wait_until(lambda: page.evaluate("() => document.querySelector('#picture canvas').width > 0"), "it is laid out")
    page.wait_for_function(
        """() => {
          const canvas = document.querySelector("#picture canvas");
          return canvas.getContext("2d").getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data[3] === 255;
        }"""
    )  # it is shown at last, without
    assert (sides(page), boxes(page, "picture")) == ([], {})
    near_ns = T_NS + 951 * MS
    page_service.give(skeleton(near_ns, STANDING + LEFT), objects(near_ns, (-0.5, 0.0, 2.0)))
    page_service.give(photograph(T_NS + 1000 * MS))
    wait_until(lambda: sides(page) == ["left"] and "1 cup" in boxes(page, "picture"), "what is 49 ms off is drawn")


def test_labels_of_things_close_together_cover_no_other(page_service: Served, open_in_3d: Open) -> None:
    page = opened(open_in_3d, page_service)
    close = [(0.02 * number, 0.01 * number, 2.0) for number in range(5)]
    step = 0

    def given() -> None:
        nonlocal step
        stamp_ns = T_NS + step * 33 * MS
        people = skeleton(stamp_ns, STANDING, STANDING + np.array([0.05, 0.02, 0.1]))
        page_service.give(photograph(stamp_ns), people, objects(stamp_ns, *close))
        step += 1

    def all_shown(card: str, number: int) -> bool:
        given()
        return page.locator(f"#{card} .label").count() == number

    wait_until(lambda: all_shown("scene", 7), "two people and five objects have their labels in 3-D")
    wait_until(lambda: all_shown("picture", 5), "the objects have theirs in the picture")
    assert (covering(page, "scene"), covering(page, "picture")) == ([], [])
