"""Placement of labels on a crowded map: without overlap, or not at all."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from actum_model_inspector.text_layout import columns

Box = tuple[float, float, float, float]
"""Left, top, right, bottom; y down."""

LETTER_WIDTH = 0.56  # of a small letter, about, in units of the font's size
LINE_HEIGHT = 1.25  # of a line, in units of the font's size


@dataclass
class LabelSpace:
    """The space for labels on a map, in the map's units.

    Attributes:
        page: the box that labels must lie within.
        taken: the boxes of labels placed so far.
    """

    page: Box
    taken: list[Box] = field(default_factory=list)

    def moved_inside(self, x: float, y: float, width: float, height: float) -> tuple[float, float]:
        """Return the middle (x, y) of a box, moved by the least that brings the box onto the page."""
        left, top, right, bottom = self.page
        x = min(max(x, left + width / 2), max(right - width / 2, left + width / 2))
        return x, min(max(y, top + height / 2), max(bottom - height / 2, top + height / 2))

    def place(self, middles: Iterable[tuple[float, float]], width: float, height: float) -> tuple[float, float] | None:
        """Place a box at the first of some middles where it is on the page and overlaps no other; None if at none."""
        page = self.page
        for x, y in middles:
            box = left, top, right, bottom = x - width / 2, y - height / 2, x + width / 2, y + height / 2
            inside = page[0] <= left and page[1] <= top and right <= page[2] and bottom <= page[3]
            if inside and not any(_overlap(box, other) for other in self.taken):
                self.taken.append(box)
                return x, y
        return None


def text_size(text: str, size: float) -> tuple[float, float]:
    """Return about how wide and high some lines of text are, in the unit of the font's size."""
    lines = text.split("\n")
    return LETTER_WIDTH * size * max(map(columns, lines)), LINE_HEIGHT * size * len(lines)


def spread_apart(wanted: list[float], distance: float) -> list[float]:
    """Return the values, moved so that they lie at least a distance apart, in the same order.

    Neighbours that are too close are spread evenly about the mean of their values.
    """
    groups: list[list[float]] = []
    for value in sorted(wanted):
        groups.append([value])
        while len(groups) > 1 and _spread(groups[-1], distance)[0] < _spread(groups[-2], distance)[-1] + distance:
            groups[-2:] = [groups[-2] + groups[-1]]
    apart = [value for group in groups for value in _spread(group, distance)]
    order = sorted(range(len(wanted)), key=lambda index: wanted[index])
    return [apart[order.index(index)] for index in range(len(wanted))]


def _spread(group: list[float], distance: float) -> list[float]:
    first = sum(group) / len(group) - distance * (len(group) - 1) / 2
    return [first + distance * index for index in range(len(group))]


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
