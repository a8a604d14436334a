"""Measure all parts, or one, and write them as Markdown; about fifteen minutes on one core.

python -m benchmarks.objects [--only PART]
"""

from collections.abc import Iterator
from pathlib import Path

import cv2
from benchmarks.page import measure_page, part_asked_for, versions_of

from .parts import (
    CONTACT_PEOPLE,
    EMPTY_PEOPLE,
    FIRST_IN_CONTACT,
    FIRST_PERSON,
    FIRST_RETURNING,
    IMAGE_HZ,
    PARTS,
    POINTING_PEOPLE,
    RETURNING_PEOPLE,
    STILL_IMAGE_HZ,
)

PAGE = Path(__file__).with_name("results.md")


def header() -> Iterator[str]:
    """Say what was run, and how."""
    versions = versions_of("numpy", "opencv-python-headless")
    yield "# The right object in scenes that are hard to see"
    yield f"""`make bench-objects`: {versions}; one core."""
    yield f"""Simulated people act at a table with three marked objects in a row. Images are drawn and compressed
({IMAGE_HZ} a second, {STILL_IMAGE_HZ} for pointing), markers detected in them and tracked; hands and hips are seen 30
times a second with a Kinect's noise. Fusion is told which action was done, and when, as if it were recognised: nothing
but the object's side is measured. `proximity` is the plain smallest distance, `joint` the default; both judge the same
sightings."""
    yield f"""Protocol: every threshold was chosen on persons 101 to 170, 200 to 479 and 5000 to 5235, on OptiTrack
recordings, or from anatomy, and what is judged where the hand comes back on persons 5300 to 5326 and 5400 to 5423; the
persons here, {FIRST_IN_CONTACT} and up for push, pull, put and lift, {FIRST_RETURNING} and up from rest to rest,
{FIRST_PERSON} and up for the rest, had no part in it; how many of them point, and that the
nearest pantomimes stand by themselves, was settled after a first look at them. Each row has persons of its own:
{CONTACT_PEOPLE} for each condition and distance between the objects, {POINTING_PEOPLE} for each distance to point
from, {RETURNING_PEOPLE} for each way back and condition (`plain` and `together`) from rest to rest, and for pantomimes
{EMPTY_PEOPLE} for each nearness, condition (`plain` and `together`) and distance between the
objects (10 and 20 cm). Intervals are Wilson's, 95 %."""
    yield """Conditions: `cluttered`, 60 shapes and false squares on wall and table; `blurred`, out of focus by 0.8
pixels and the shutter open for 16 ms; `unread`, each marker by itself illegible in 30 % of the images; `covered`, the
hand over the marker from grasp to release; `together`, all of these at once. Objects 10 cm apart, and their markers,
are 0.7 times as large: 17 pixels."""
    yield """Displacements are right within 2 cm or a tenth: how far level and how far up; with direction, as the person
faces, which the hips tell to some degrees; the outcome is lifted, put down, pushed or pulled as was done. What a
hand covers is followed in the image by how the hand looks; where that fails, as where the hand itself goes behind
something, it goes with the hand's joint, which a Kinect tells to 2 cm in each axis, in errors that last for 0.15 s."""


def section(part: str) -> str:
    """Measure one part."""
    title, table = PARTS[part]
    return "\n".join([f"## {title}", "", *table()])


def main() -> None:
    only = part_asked_for("benchmarks.objects", __doc__, PARTS)
    cv2.setNumThreads(1)
    measure_page(PAGE, only, header(), PARTS, section)


if __name__ == "__main__":
    main()
