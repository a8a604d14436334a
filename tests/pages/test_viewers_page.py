"""The page on viewers names every path and every topic that messages are shown on."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from docs.generate import fields
from typer.main import get_command

from actum.codec import schema_name
from actum.messages import MESSAGES, Message
from actum_command.__main__ import app

PAGE = (Path(__file__).parents[2] / "docs" / "viewers.md").read_text(encoding="utf-8")


def examples() -> Iterator[Message]:
    for message in MESSAGES:
        for example in fields.examples()[schema_name(message)]:
            yield message.model_validate_json(json.dumps(example))


def on_page(name: str) -> bool:
    """Tell whether the page has a name, also where only the last part of it is written, beside another."""
    return f"`{name}`" in PAGE or (f"`{name.rpartition('/')[0]}/" in PAGE and f"`{name.rpartition('/')[2]}`" in PAGE)


def generic(path: str) -> str:
    path = re.sub(r"(people|courses)/\d+", r"\1/<agent>", path.replace("kinect0", "<sensor>"))
    return re.sub(r"objects/\d+", "objects/<id>", path)


def test_the_page_has_every_path_in_rerun() -> None:
    pytest.importorskip("rerun", reason="rerun-sdk is not installed: pip install -e '.[view]'")
    from actum_command.viewers.rerun_entries import TIMELINE, RerunEntries

    entries = RerunEntries()
    paths = {generic(entry.path) for message in examples() for entry in entries.of(message) if not entry.static}
    assert len(paths) > 8
    assert [path for path in sorted(paths) if not on_page(path)] == []
    assert f"`{TIMELINE}`" in PAGE


def test_the_page_has_every_topic_in_foxglove_with_its_schema() -> None:
    pytest.importorskip("foxglove", reason="foxglove-sdk is not installed: pip install -e '.[dev]'")
    from actum_command.viewers.foxglove_messages import CONTENTS, TRANSFORMS, below

    missing = [leaf for leaf in CONTENTS if f"`{below('<sensor>', leaf)}`" not in PAGE]
    assert (missing, f"`{TRANSFORMS}`" in PAGE) == ([], True)
    theirs = {kind.__name__ for kind in CONTENTS.values() if not issubclass(kind, Message)}
    assert [name for name in sorted(theirs) if f"`{name}`" not in PAGE] == []


@pytest.mark.parametrize("command", ["view", "foxglove", "export"])
def test_the_pages_options_exist(command: str) -> None:
    known = {option for each in get_command(app).commands[command].params for option in each.opts}  # type: ignore[attr-defined]
    named = {
        option for line in re.findall(rf"actum {command}([^#`\n]*)", PAGE) for option in re.findall(r"-[-\w]+", line)
    }
    assert named
    assert named <= known
