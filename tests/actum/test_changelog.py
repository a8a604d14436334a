"""The changelog tells the version of every message's schema."""

import re
from itertools import dropwhile, takewhile
from pathlib import Path

from actum import schemas

CHANGELOG = Path(__file__).parents[2] / "CHANGELOG.md"
ROW = re.compile(r"\| `([a-z_.]+)` \| (\d+) \|")


def newest_table() -> set[str]:
    """Read the schemas of the topmost table as the files are named, e.g. `actum.skeleton.1.json`."""
    lines = dropwhile(lambda line: line != "### Message schemas", CHANGELOG.read_text(encoding="utf-8").splitlines())
    section = takewhile(lambda line: not line.startswith("## "), lines)
    return {f"{row[1]}.{row[2]}.json" for row in map(ROW.fullmatch, section) if row}


def test_the_newest_table_names_every_schema_file_and_no_other() -> None:
    assert newest_table() == {file.name for file in Path(schemas.__file__).parent.glob("*.json")} != set()
