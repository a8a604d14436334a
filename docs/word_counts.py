"""Count the words of README, CONTRIBUTING and docs, page by page, with and without the generated parts.

`python -m docs.word_counts` counts the pages as they are, and with `REF` behind it also those of that git reference. A
page that a version lacks is shown as `absent` there.
"""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from docs.generate.pages import PART

ROOT = Path(__file__).parents[1]
AT_THE_TOP = ("README.md", "CONTRIBUTING.md")
"""The pages outside of `docs/` that are counted."""
ABSENT = "absent"
WIDTHS = (24, 9, 9, 9, 9)
"""Columns: page, then words in all and words written by hand, before and after (characters)."""


def counted(text: str) -> tuple[int, int]:
    """Return the number of words of a page: all of them, and those outside of generated parts."""
    return len(text.split()), len(PART.sub("", text).split())


def pages_of(ref: str) -> dict[str, str]:
    """Read README, CONTRIBUTING and docs as they are at a git reference, by path, without those that it lacks."""
    paths = _git("ls-tree", "--name-only", ref, *AT_THE_TOP, "docs/").split()
    return {path: _git("show", f"{ref}:{path}") for path in paths if path.endswith(".md")}


def pages_here() -> dict[str, str]:
    """Read README, CONTRIBUTING and docs as they are in the work tree, by path."""
    files = [*(ROOT / name for name in AT_THE_TOP), *sorted((ROOT / "docs").glob("*.md"))]
    return {file.relative_to(ROOT).as_posix(): file.read_text(encoding="utf-8") for file in files}


def lines(*versions: dict[str, str]) -> list[str]:
    """Lay out one row for each page with two columns for each version, and their sums."""
    paths = sorted(set().union(*versions), key=lambda path: (path.startswith("docs/"), path))
    rows = [[count for pages in versions for count in _counts(pages, path)] for path in paths]
    sums = [sum(count for count in column if isinstance(count, int)) for column in zip(*rows, strict=True)]
    heads = ["all", "by hand"] * len(versions)
    return [_row("page", heads), *map(_row, paths, rows), _row("sum", sums)]


def _counts(pages: dict[str, str], path: str) -> Sequence[int | str]:
    return counted(pages[path]) if path in pages else (ABSENT, ABSENT)


def _row(first: str, cells: Sequence[int | str]) -> str:
    return first.ljust(WIDTHS[0]) + "".join(
        str(cell).rjust(width) for cell, width in zip(cells, WIDTHS[1:], strict=False)
    )


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    print("\n".join(lines(*map(pages_of, sys.argv[1:2]), pages_here())))
