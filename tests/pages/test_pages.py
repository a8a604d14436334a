"""The pages name what there is: modules, files, commands, make targets; and the README stays short."""

import re
import subprocess
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from docs import word_counts
from docs.word_counts import counted, lines
from typer.main import get_command

import actum.som
from actum_command.__main__ import app

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "deploy/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "benchmarks").rglob("*.md")),
]
OURS = "|".join(sorted(file.parent.name for file in ROOT.glob("*/*/__init__.py")))
FOLDERS = "shared|services|tests|docs|benchmarks|deploy|examples"
MOST_WORDS = 1300
MOST_WORDS_OF_A_PAGE = 2500
PRINTED = ("results.md", "bimacs.md", "cutting.md", "continuous.md", "correcting.md", "som.md")
"""Pages that a benchmark prints, tables above all."""

every_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def found(pattern: str, page: Path) -> list[str]:
    return sorted(set(re.findall(pattern, page.read_text(encoding="utf-8"))))


def blocks(page: Path) -> str:
    """Return the blocks of commands of a page; those of other languages are none."""
    fenced = re.findall(r"(?ms)^```(\w*)$\n(.*?)^```$", page.read_text(encoding="utf-8"))
    return "\n".join(text for language, text in fenced if language in ("", "sh"))


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) < MOST_WORDS


@every_page
def test_a_page_is_read_in_ten_minutes(page: Path) -> None:
    _, by_hand = counted(page.read_text(encoding="utf-8"))
    assert by_hand <= MOST_WORDS_OF_A_PAGE or page.name in PRINTED


def test_words_are_counted_with_and_without_what_is_generated() -> None:
    before = {"README.md": "one two", "docs/a.md": "three\n<!-- generated: fields -->\n\nfour\n<!-- end -->\n"}
    _, *rows, total = lines(before, {"docs/a.md": "three"})
    assert [row.split() for row in rows] == [
        ["README.md", "2", "2", "absent", "absent"],
        ["docs/a.md", "9", "1", "1", "1"],
    ]
    assert total.split() == ["sum", "11", "3", "1", "1"]


def test_the_words_of_contributing_are_counted_also_beside_a_reference_that_lacks_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(word_counts, "ROOT", tmp_path)
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b.c"]
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "a.md").write_text("one")
    (tmp_path / "README.md").write_text("one two")
    for arguments in (["init", "--quiet"], ["add", "."], ["commit", "--quiet", "--message", "a"]):
        subprocess.run([*git, *arguments], check=True)
    (tmp_path / "CONTRIBUTING.md").write_text("one two three")
    _, *rows, _ = lines(word_counts.pages_of("HEAD"), word_counts.pages_here())
    assert [row.split() for row in rows] == [
        ["CONTRIBUTING.md", "absent", "absent", "3", "3"],
        ["README.md", "2", "2", "2", "2"],
        ["docs/a.md", "1", "1", "1", "1"],
    ]


def test_the_readme_leads_to_every_page() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    leading = ["CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff", "SECURITY.md", "LICENSE"]
    assert [name for name in leading if f"({name})" not in readme] == []
    assert [page.name for page in (ROOT / "docs").glob("*.md") if f"(docs/{page.name})" not in readme] == []


def test_the_pages_that_go_through_the_code_name_it() -> None:
    named = {page.name: len(found(rf"`((?:{OURS})\.[\w.]+)`", page)) for page in PAGES}
    assert named["paper.md"] > 10
    assert named["architecture.md"] > 40


@every_page
def test_every_name_of_ours_on_a_page_exists(page: Path) -> None:
    missing = [name for name in found(rf"`((?:{OURS})\.[\w.]+)`", page) if not exists(name)]
    assert missing == []


@every_page
def test_every_path_on_a_page_exists(page: Path) -> None:
    paths = found(rf"(?<![\w/.<>-])((?:{FOLDERS})/[\w./-]*\w)", page)
    assert [path for path in paths if not (ROOT / path).exists()] == []


@every_page
def test_every_command_on_a_page_exists(page: Path) -> None:
    groups = get_command(app)
    named = found(r"(?:`|bin/)actum ([a-z][\w-]*)", page)
    named += re.findall(r"(?m)^(?:[\w-]*\$ +)?actum ([a-z][\w-]*)", blocks(page))
    assert [name for name in named if name not in groups.commands] == []  # type: ignore[attr-defined]


@every_page
def test_every_make_target_on_a_page_exists(page: Path) -> None:
    targets = set(re.findall(r"(?m)^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8")))
    named = found(r"`make ([a-z][\w-]*)", page) + re.findall(r"(?m)(?:^| )make ([a-z][\w-]*)", blocks(page))
    assert [name for name in named if name not in targets] == []


@every_page
def test_every_link_elsewhere_is_well_formed(page: Path) -> None:
    for url in found(r"\]\(((?:https?|mailto):[^)]*)\)", page):
        parts = urlsplit(url)
        assert parts.scheme == "https", url
        assert re.fullmatch(r"[\w-]+(\.[\w-]+)+", parts.netloc), url
        assert not re.search(r"\s", url), url


def test_the_examples_of_the_page_on_maps_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    examples = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "som.md").read_text(encoding="utf-8"), re.S)
    assert len(examples) > 1
    exec("\n".join(examples), {})


def test_the_page_on_maps_has_all_that_the_library_offers() -> None:
    page = (ROOT / "docs" / "som.md").read_text(encoding="utf-8")
    assert [name for name in actum.som.__all__ if not re.search(rf"\b{name}\b", page)] == []


def exists(name: str) -> bool:
    """Tell whether a dotted name is a module, or something in one."""
    module, rest = name, []
    while not is_module(module):
        module, _, attribute = module.rpartition(".")
        rest.insert(0, attribute)
    held = import_module(module)
    for attribute in rest:
        if not hasattr(held, attribute):
            return False
        held = getattr(held, attribute)
    return True


def is_module(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ModuleNotFoundError:
        return False
