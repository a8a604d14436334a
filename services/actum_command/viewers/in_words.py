"""The line of words that a viewer's log shows of a message."""

from rich.text import Text

from actum.messages import Action, Event, Image, Message, Objects, Segment, Skeleton, Truth
from actum_command.describing import describe

PIXEL_BYTES = {"bgr8": 3, "depth16_mm": 2}
"""Bytes of a pixel of the formats that are not compressed."""


def log_line(message: Message) -> str | None:
    """Describe a mark, an answer, or why what was captured is not valid; None for all that a log need not have.

    Partial actions are courses, not lines: there is one with every frame.
    """
    match message:
        case Segment() | Truth() | Event():
            pass
        case Action() if message.final or not message.valid:
            pass
        case Skeleton() | Objects() | Image() if not message.valid:
            pass
        case Image() if (problem := misfit(message)) is not None:
            return problem
        case _:
            return None
    return Text.from_markup(describe(message)).plain


def misfit(image: Image) -> str | None:
    """Say what is wrong with an image whose bytes are not as many as its size asks for, so that none can be shown."""
    if image.format == "jpeg":
        return None
    expected = image.height * image.width * PIXEL_BYTES[image.format]
    if len(image.data) == expected:
        return None
    return (
        f"a {image.format} image of {image.width}x{image.height} has {expected} bytes, but this one has "
        f"{len(image.data)}"
    )
