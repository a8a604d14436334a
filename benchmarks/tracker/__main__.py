"""Measure all parts, or one, and write them as Markdown; about ten minutes on one core.

python -m benchmarks.tracker [--only PART]
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import cv2
from benchmarks.page import measure_page, part_asked_for, versions_of

from .accuracy import FAMILIES, SIDES_PX, accuracy
from .cut_outs import ANGLES_DEG, FAMILY, NUMBERS, SIDE_PX, cut_outs
from .marker_scenes import CONDITIONS, HZ, IMAGES
from .rendering import SAMPLES
from .speed import speed

PAGE = Path(__file__).with_name("results.md")
PARTS: Mapping[str, tuple[str, Callable[[], Iterator[str]]]] = {
    "speed": ("Speed", speed),
    "accuracy": ("Accuracy", accuracy),
    "cut-outs": ("Markers cut out with hardly any white", cut_outs),
}
ABOUT = {
    "speed": """Eight markers go slowly over a cluttered 640×480 colour image, 60 times a second. `bare detection` is
OpenCV's, without refinement of corners and without poses; `tracker` is the whole step from colour image to objects, by
a scene file that names just these markers; with `one missing` it names a ninth, which is searched for. The times of an
image are means of processor time; the three take turns on the same images. `objects`: the fewest seen in an image.""",
    "accuracy": f"""Twelve markers in a 640×480 image of a cluttered wall, at poses that are known exactly; a pixel is
the mean of {SAMPLES}×{SAMPLES} samples of what it covers, then come blur and noise. A scene is {IMAGES} images at
{HZ} a second, in which the markers drift by up to a pixel an image: one for each of {len(FAMILIES)} families,
{len(SIDES_PX)} sides (of the black square, {SIDES_PX[0]} to {SIDES_PX[-1]} px if it faced the camera) and
{len(CONDITIONS)} conditions. Their seeds had no part in making the tracker. Conditions: `plain`, turned away by up to
40°, blur 0.7 px (standard deviation), noise 2 grey levels, a cell of white paper around; the others differ in this:
`steep`, 50 to 75°; `blurred`, 1.4 px; `noisy`, 8 grey levels; `cut out`, half a cell of paper, on a dark wall; `half in
shadow`, the edge of a shadow that takes 65 % of the light falls on the marker. Ink and paper are drawn for each marker.

A marker counts as found where all its corners are within a fifth of its side (or 2 px) of the true ones; `wrong` counts
other ids and places. Corners and distances are compared by the markers that all rows found; every row's distance comes
from its corners by the tracker's own pose estimation. ± is half the 95 % interval over draws of scenes.

Rows: OpenCV's detection with each of its refinements of corners (those of `APRILTAG` are moved by the half pixel by
which its origin differs); ours; and ours with one part left out by replacing its function for the run:
`no alignment`, small markers keep the corners of their edges (so nothing is aligned in place either);
`no in-place reading`, small markers are not aligned where they were but read by their edges again;
`every image searched`, nothing is read where it was; `no edge refinement`, OpenCV's rough corners are read;
`no second look`, squares that OpenCV could not decode are left; `no inner squares`, where OpenCV takes the paper for
the marker it is left; `no reading in shadow`, cells are parted in the middle between black and white alone; `no
sharpening`, narrow cells are read as they are.""",
    "cut-outs": f"""{len(NUMBERS)} markers of {FAMILY}, {SIDE_PX} px, turned in the image by each of {len(ANGLES_DEG)}
angles, with so much white paper left around them, on something as dark as their ink. Found: one marker of that id,
whose side is right to 1.5 px: where the paper's outline is taken for the marker's it is larger.""",
}


def header() -> Iterator[str]:
    """Say what was run."""
    versions = versions_of("numpy", "opencv-python-headless")
    yield "# The marker tracker beside OpenCV"
    yield f"`make bench-tracker`: {versions}; one core."


def section(part: str) -> str:
    """Measure one part."""
    title, table = PARTS[part]
    return "\n".join([f"## {title}", "", ABOUT[part], "", *table()])


def main() -> None:
    only = part_asked_for("benchmarks.tracker", __doc__, PARTS)
    cv2.setNumThreads(1)
    measure_page(PAGE, only, header(), PARTS, section)


if __name__ == "__main__":
    main()
