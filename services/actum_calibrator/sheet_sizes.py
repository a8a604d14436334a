"""The paper sizes of printed sheets."""

from enum import StrEnum


class SheetSize(StrEnum):
    """A size of paper, by the name that a user gives it."""

    A4 = "a4"
    LETTER = "letter"

    @property
    def portrait_mm(self) -> tuple[float, float]:
        """Width and height of the upright sheet, in mm."""
        return (210.0, 297.0) if self is SheetSize.A4 else (215.9, 279.4)
