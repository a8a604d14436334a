"""The diagram of the processes and the keys between them, as an SVG that shows on GitHub and on the site."""

from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from actum.keys import ACTION, BASE, COLOR, EVENT, OBJECTS, POSTURE, SEGMENT, SKELETON, Topic

DIAGRAM = Path(__file__).parents[1] / "architecture.svg"
WIDTH, HEIGHT = 600, 590
BOX_PX = 46
STYLE = """
  svg { font: 14px system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
  .paper { fill: #ffffff; } text { fill: #1c2128; }
  .service { fill: #e4efff; stroke: #3b6fb5; stroke-width: 1.5; }
  .other { fill: #f3f3f3; stroke: #7a7a7a; stroke-width: 1.5; stroke-dasharray: 5 4; }
  .way { stroke: #57606a; stroke-width: 1.5; fill: none; marker-end: url(#head); } .head { fill: #57606a; }
  .key { font-family: ui-monospace, SFMono-Regular, Menlo, monospace; font-size: 12.5px; fill: #8a4b00; }
  .small { font-size: 12.5px; }
  @media (prefers-color-scheme: dark) {
    .paper { fill: #16191d; } text { fill: #e6e9ee; }
    .service { fill: #1e3350; stroke: #79a8e8; } .other { fill: #24272c; stroke: #9aa0a6; }
    .way { stroke: #b4bbc4; } .head { fill: #b4bbc4; } .key { fill: #ffb566; }
  }
"""


@dataclass(frozen=True)
class Box:
    """A process at its left and upper edge, or something that is not ours."""

    name: str
    x: int
    y: int
    width: int
    below: str = ""
    ours: bool = True


@dataclass(frozen=True)
class Way:
    """What goes from one box to another: the points of its line, its key and where that is written."""

    points: tuple[tuple[int, int], ...]
    topic: Topic
    x: int
    y: int


BOXES = (
    Box("webcam, depth camera, recording", 170, 16, 410, "or the simulated scene's actor", ours=False),
    Box("sensor_gateway", 170, 106, 410, "or scene_simulator in its place"),
    Box("pose_preprocessor", 170, 216, 190, "postures in body frames"),
    Box("marker_tracker", 390, 216, 190, "poses of the objects"),
    Box("som_classifier", 130, 326, 190, "which action"),
    Box("switch or script", 16, 216, 134, "marks start, end", ours=False),
    Box("action_fusion", 170, 436, 410, "which object, what became of it"),
    Box("your program", 170, 530, 190, ours=False),
    Box("web_dashboard", 390, 530, 190, "all keys, in browsers"),
)
WAYS = (
    Way(((375, 62), (375, 106)), SKELETON, 0, 0),
    Way(((265, 152), (265, 216)), SKELETON, 273, 188),
    Way(((485, 152), (485, 216)), COLOR, 493, 188),
    Way(((225, 262), (225, 326)), POSTURE, 217, 298),
    Way(((345, 262), (345, 436)), POSTURE, 352, 356),
    Way(((485, 262), (485, 436)), OBJECTS, 493, 356),
    Way(((70, 262), (70, 349), (130, 349)), SEGMENT, 62, 310),
    Way(((130, 360), (90, 360), (90, 553), (170, 553)), SEGMENT, 82, 460),
    Way(((225, 372), (225, 436)), ACTION, 217, 408),
    Way(((265, 482), (265, 530)), EVENT, 273, 511),
    Way(((485, 482), (485, 530)), EVENT, 493, 511),
)


def diagram() -> str:
    """Draw it."""
    parts = [f'<rect class="paper" width="{WIDTH}" height="{HEIGHT}" rx="10"/>']
    parts += [_way(way) for way in WAYS] + [_box(box) for box in BOXES]
    title = "The processes of actum and the keys between them"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
        f'role="img" aria-label="{title}">\n<title>{title}; keys below {BASE}/&lt;sensor&gt;/</title>\n'
        f"<style>{STYLE}</style>\n"
        '<marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
        '<path class="head" d="M0 0 8 4 0 8z"/></marker>\n' + "\n".join(parts) + "\n</svg>\n"
    )


def _box(box: Box) -> str:
    kind, middle = "service" if box.ours else "other", box.x + box.width // 2
    name_y = box.y + (20 if box.below else 28)
    return (
        f'<rect class="{kind}" x="{box.x}" y="{box.y}" width="{box.width}" height="{BOX_PX}" rx="6"/>'
        f'<text x="{middle}" y="{name_y}" text-anchor="middle">{box.name}</text>'
        f'<text class="small" x="{middle}" y="{box.y + 38}" text-anchor="middle">{box.below}</text>'
    )


def _way(way: Way) -> str:
    line = "M" + " ".join(f"{x} {y}" for x, y in way.points)
    key = escape(way.topic.leaf.format("<agent>"))
    side = "end" if way.x < way.points[0][0] else "start"
    label = f'<text class="key" x="{way.x}" y="{way.y}" text-anchor="{side}">{key}</text>' if way.x else ""
    return f'<path class="way" d="{line}"/>{label}'
