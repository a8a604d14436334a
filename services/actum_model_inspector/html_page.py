"""The HTML page that shows all pictures: one file without scripts, which a browser opens from the disk."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from itertools import groupby
from urllib.parse import quote

from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.inspection import Picture
from actum_model_inspector.style import missing_glyphs
from actum_model_inspector.text_layout import shortened
from actum_model_trainer.evaluation import Evaluation
from som_classifier.model import Model
from som_classifier.model_maps import NoMapsError, maps_of

STYLE_SHEET = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 75rem; margin: 2rem auto; padding: 0 1rem; }
body { overflow-wrap: anywhere; }
h1 { font-size: 1.6rem; margin-bottom: 0; }
h2 { font-size: 1.2rem; margin-top: 3rem; border-top: 1px solid #ddd; padding-top: 1rem; }
p, figcaption { color: #555; max-width: 45rem; }
nav a { margin-right: 1rem; display: inline-block; }
.pictures { display: grid; gap: 1.5rem; align-items: start; }
.pictures { grid-template-columns: repeat(auto-fill, minmax(min(34rem, 100%), 1fr)); }
figure { margin: 0; }
img { width: 100%; height: auto; border: 1px solid #ddd; border-radius: 4px; }
"""


def page(
    model: Model,
    segments: Sequence[AnsweredSegment],
    evaluation: Evaluation | None,
    planned: Sequence[Picture],
    files: Mapping[str, str],
) -> str:
    """Return the page as HTML.

    Args:
        model: the model that the pictures show.
        segments: the segments that it answered.
        evaluation: of its answers, None where no segment has a label.
        planned: the pictures in their order.
        files: the file of each picture, by the picture's name.
    """
    sections = [(title, list(group)) for title, group in groupby(planned, key=lambda picture: picture.section)]
    links = [f'<a href="#{number}">{escape(title)}</a>' for number, (title, _) in enumerate(sections)]
    facts = [model_facts(model), *test_facts(model, segments, evaluation), *missing_letters(model, segments)]
    return "\n".join(
        [
            '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>Model {escape(model.id)}</title>\n<style>{STYLE_SHEET}</style>\n</head>\n<body>",
            f"<h1>What model {escape(model.id)} sees</h1>",
            *(f"<p>{escape(fact)}</p>" for fact in facts),
            "<p>On all figures the actor's right is orange and the left blue, seen from in front. Click a picture to "
            "see it alone.</p>",
            f"<nav>{' '.join(links)}</nav>",
            *(_section(number, title, group, files) for number, (title, group) in enumerate(sections)),
            "</body>\n</html>\n",
        ]
    )


def model_facts(model: Model) -> str:
    """Return sentences on the model's kind, preset and training, and on missing maps."""
    metadata = model.metadata
    people = f" by {len(metadata.persons)} people" if len(metadata.persons) > 1 else ""
    return (
        f"Kind {metadata.kind}, preset {metadata.preset}, seed {metadata.seed}; trained on "
        f"{metadata.samples} samples{people} of {len(metadata.labels)} actions: {', '.join(metadata.labels)}."
        + ("" if maps_of(model) else f" No maps are drawn: {NoMapsError(model)}.")
    )


def missing_letters(model: Model, segments: Sequence[AnsweredSegment]) -> Iterable[str]:
    """Yield a sentence on the letters of the actions' names that the pictures cannot show, if there are any."""
    names = [*model.metadata.labels, *(segment.label or "" for segment in segments)]
    if letters := missing_glyphs(" ".join(names)):
        yield (
            f"Boxes stand for {shortened(letters, 40)} in the pictures: no font here has these letters. A font such as "
            "Noto Sans for their script, or --format svg, shows them."
        )  # fmt: skip


def test_facts(model: Model, segments: Sequence[AnsweredSegment], evaluation: Evaluation | None) -> Iterable[str]:
    """Yield sentences on the number of segments, the right answers, and the people who were also in the training."""
    if segments:
        rejected = sum(segment.recognition is None for segment in segments)
        yield f"Tried on {len(segments)} segments" + (f", of which it rejected {rejected}." if rejected else ".")
    if evaluation is not None and evaluation.n:
        yield f"{evaluation.correct} of {evaluation.n} with a label recognised: {evaluation.accuracy:.1%}."
    known = sorted({segment.person for segment in segments if segment.person} & set(model.metadata.persons))
    if known:
        yield (
            f"Person {', '.join(known)} also performed for the training: on people it has not seen it may be right "
            "less often."
        )  # fmt: skip


def _section(number: int, title: str, group: Sequence[Picture], files: Mapping[str, str]) -> str:
    figures = "\n".join(_figure(picture, files[picture.name]) for picture in group)
    return f'<h2 id="{number}">{escape(title)}</h2>\n<div class="pictures">\n{figures}\n</div>'


def _figure(picture: Picture, file: str) -> str:
    link = quote(file)
    return (
        f'<figure id="{escape(picture.name)}"><a href="{link}"><img src="{link}" loading="lazy" '
        f'alt="{escape(picture.name)}"></a><figcaption>{escape(picture.caption)}</figcaption></figure>'
    )
