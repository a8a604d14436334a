import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from actum_model_inspector.style import missing_glyphs
from actum_model_inspector.text_layout import shortened, wrapped


@pytest.mark.parametrize(
    ("text", "width", "lines", "broken"),
    [
        ("horizontal arm wave", 14, 2, "horizontal arm\nwave"),
        ("put the red cup down", 11, 2, "put the red\ncup down"),
        ("", 14, 2, ""),
        ("pick_up_the_cup_and_drink", 22, 1, "pick_up_the_cup_and_d…"),
        ("pick_up_the_cup_and_drink", 14, 2, "pick_up_the_\ncup_and_drink"),
        ("Donaudampfschifffahrt", 8, 2, "Donaudam\npfschif…"),
        ("two\nlines\tand \x07 bell", 40, 1, "two lines and bell"),
        ("物を持ち上げる", 8, 2, "物を持ち\n上げる"),
    ],
)
def test_names_are_broken_between_words_and_cut_where_there_is_no_room(
    text: str, width: int, lines: int, broken: str
) -> None:
    assert wrapped(text, width, lines) == broken


@given(st.text(), st.integers(2, 30), st.integers(1, 3))
def test_no_line_is_wider_than_its_room_and_what_fits_is_whole(text: str, width: int, lines: int) -> None:
    broken = wrapped(text, width, lines).split("\n")
    assert len(broken) <= lines
    assert all(cell_len(line) <= width for line in broken)
    if cell_len(text) <= width and text.isprintable():
        assert broken == [" ".join(text.split())]


def test_ideographs_take_the_room_of_two_letters() -> None:
    assert shortened("持" * 9, 7) == "持持持…"


def test_letters_that_no_font_has_are_named_once() -> None:
    assert missing_glyphs("push Ünal тянуть") == ""
    assert missing_glyphs("a\ue000b\ue000\t") == "\ue000"
