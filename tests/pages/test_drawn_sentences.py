"""The drawn sentences are those that users meet, and a seed draws the same ones again."""

import pytest
from docs import drawn_sentences

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def errors() -> set[str]:
    return drawn_sentences.errors()


def test_errors_of_services_of_commands_and_of_doctor_are_among_them(errors: set[str]) -> None:
    assert (
        "--source recording needs --path (ACTUM_PATH): give the recording to play, or a folder of recordings" in errors
    )
    assert "{file} is a folder: give the name of a file" in errors
    assert "{name} does not answer queries on its info key: if this persists, restart {name}" in errors


def test_helps_of_commands_of_their_options_and_of_settings_are_among_them() -> None:
    named = {text.partition(":")[0] for text in drawn_sentences.helps()}
    assert {"actum label relabel", "actum label relabel REC", "actum calibrate intrinsics --live"} <= named
    assert {"actum up --camera-size", "python -m sensor_gateway --camera-size TEXT"} <= named


def test_paragraphs_hold_neither_tables_nor_code() -> None:
    assert not [text for text in drawn_sentences.paragraphs() if "| ---" in text or "```" in text]


def test_a_seed_draws_the_same_sentences_again(
    errors: set[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawn_sentences, "errors", lambda: errors)
    drawn = []
    for _ in range(2):
        drawn_sentences.main(["--seed", "7"])
        drawn.append(capsys.readouterr().out)
    assert drawn[0] == drawn[1]
    assert drawn[0].startswith("seed 7\n")
