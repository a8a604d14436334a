import re
from dataclasses import replace
from pathlib import Path

import pytest

from actum.recording import Recording
from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.html_page import page
from actum_model_inspector.inspection import Picture, pictures
from actum_model_trainer.evaluation import evaluate
from som_classifier.model_maps import ModelMaps


def shown(maps: ModelMaps, segments: list[AnsweredSegment], recording: Recording) -> tuple[str, list[Picture]]:
    evaluation = evaluate(maps.model, [recording])
    planned = list(pictures(maps.model, segments, evaluation))
    files = {picture.name: f"{picture.name}.png" for picture in planned}
    return page(maps.model, segments, evaluation, planned, files), planned


def test_the_page_shows_every_picture_with_a_caption_links_and_what_the_model_is_and_nothing_from_elsewhere(
    maps: ModelMaps, segments: list[AnsweredSegment], recording: Recording
) -> None:
    written, planned = shown(maps, segments, recording)
    assert re.findall(r'<img src="([^"]+)"', written) == [f"{picture.name}.png" for picture in planned]
    assert written.count("<figcaption>") == len(planned)
    assert "://" not in written
    assert "<script" not in written

    targets = re.findall(r'href="#([^"]+)"', written)
    assert targets
    assert all(f'id="{target}"' in written for target in targets)

    right = sum(segment.correct for segment in segments)
    assert maps.model.id in written
    assert "Tried on 3 segments." in written
    assert f"{right} of 3 with a label recognised" in written


@pytest.mark.parametrize(("person", "warned"), [("1", True), ("2", False)])
def test_it_warns_where_the_same_person_trained_the_model(
    maps: ModelMaps, segments: list[AnsweredSegment], recording: Recording, person: str, warned: bool
) -> None:
    own = [
        AnsweredSegment(s.file, person, s.segment_id, s.label, s.frames, s.recognition, s.action_unit) for s in segments
    ]
    assert ("also performed for the training" in shown(maps, own, recording)[0]) == warned


def test_names_are_text_and_never_markup(maps: ModelMaps) -> None:
    picture = Picture("<script>", "time-a b&c", "a < b", lambda: pytest.fail("nothing is drawn"))
    written = page(maps.model, [], None, [picture], {picture.name: str(Path("time-a b&c.png"))})
    assert "<script>" not in written
    assert 'src="time-a%20b%26c.png"' in written


def test_letters_that_the_pictures_cannot_show_are_named(segments: list[AnsweredSegment], maps: ModelMaps) -> None:
    known = page(maps.model, segments, None, [], {})
    strange = [replace(segments[0], label="\ue000push")]
    assert "Boxes stand for" not in known
    assert "Boxes stand for \ue000 in the pictures" in page(maps.model, strange, None, [], {})
