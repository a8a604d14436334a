"""Names on a crowded map: each where there is room, or not at all."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from actum_model_inspector.text_layout import columns

Box = tuple[float, float, float, float]
"""Left, top, right, bottom; y down."""

CHARACTER, LINE = 0.56, 1.25
"""About how wide and how high letters are, in units of their size."""


@dataclass
class LabelSpace:
    """What is taken of a map, in its own units.

    Attributes:
        page: what names must lie within.
        taken: what they must not cover.
    """

    page: Box
    taken: list[Box] = field(default_factory=list)

    def within(self, x: float, y: float, width: float, height: float) -> tuple[float, float]:
        """Move the middle of a box as far as needed to bring it onto the page."""
        left, top, right, bottom = self.page
        x = min(max(x, left + width / 2), max(right - width / 2, left + width / 2))
        return x, min(max(y, top + height / 2), max(bottom - height / 2, top + height / 2))

    def place(self, middles: Iterable[tuple[float, float]], width: float, height: float) -> tuple[float, float] | None:
        """Take the first of some places at which a box is on the page and covers nothing, if there is one."""
        for x, y in middles:
            box = _box(x, y, width, height)
            if _inside(box, self.page) and not any(_overlap(box, other) for other in self.taken):
                self.taken.append(box)
                return x, y
        return None


def text_size(text: str, size: float) -> tuple[float, float]:
    """Return about how wide and high some lines of text are, in the unit of the letters' size."""
    lines = text.split("\n")
    return CHARACTER * size * max(map(columns, lines)), LINE * size * len(lines)


def spread(wanted: list[float], distance: float) -> list[float]:
    """Move values, least first, as little apart as keeps them at least a distance from each other, order kept.

    Neighbours that are too near become a group about the mean of where they wanted to be.
    """
    groups: list[list[float]] = []
    for value in sorted(wanted):
        groups.append([value])
        while len(groups) > 1 and _first(groups[-1], distance) < _last(groups[-2], distance) + distance:
            groups[-2:] = [groups[-2] + groups[-1]]
    apart = [_first(group, distance) + distance * index for group in groups for index in range(len(group))]
    order = sorted(range(len(wanted)), key=lambda index: wanted[index])
    return [apart[order.index(index)] for index in range(len(wanted))]


def _first(group: list[float], distance: float) -> float:
    return sum(group) / len(group) - distance * (len(group) - 1) / 2


def _last(group: list[float], distance: float) -> float:
    return sum(group) / len(group) + distance * (len(group) - 1) / 2


def _box(x: float, y: float, width: float, height: float) -> Box:
    return x - width / 2, y - height / 2, x + width / 2, y + height / 2


def _inside(box: Box, page: Box) -> bool:
    return page[0] <= box[0] and page[1] <= box[1] and box[2] <= page[2] and box[3] <= page[3]


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
