"""A module-level name is assigned once: a second value, or the same once more, is an edit gone wrong."""

import ast
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("services", "shared", "benchmarks", "docs", "examples", "tests")


def assigned_names(text: str) -> Counter[str]:
    """Count the assignments of each name at the top of a module; branches of an `if` or a `try` are alternatives."""
    targets: list[ast.expr] = []
    for statement in ast.parse(text).body:
        match statement:
            case ast.Assign():
                targets += statement.targets
            case ast.AnnAssign(value=ast.expr()):
                targets.append(statement.target)
    stored = (node for target in targets for node in ast.walk(target))
    return Counter(node.id for node in stored if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_module_level_name_is_assigned_once(folder: str) -> None:
    modules = {file: assigned_names(file.read_text(encoding="utf-8")) for file in (ROOT / folder).rglob("*.py")}
    assert modules, "nothing was read"
    twice = [
        f"{file.relative_to(ROOT)}: {name}"
        for file, names in modules.items()
        for name, count in names.items()
        if count > 1
    ]
    assert twice == []


@pytest.mark.parametrize(
    ("text", "twice"),
    [
        ("A = 1\nB = 2\nA = 1", True),
        ("A = 1\nA: int = 2", True),
        ("A, B = 1, 2\nB = 3", True),
        ("A: int\nA = 1", False),
        ("A = [1]\nA += [2]\nA[0] = 3", False),
        ("if X:\n    A = 1\nelse:\n    A = 2", False),
        ("try:\n    A = 1\nexcept NameError:\n    A = 2", False),
        ("A = 1\ndef f() -> None:\n    A = 2", False),
    ],
)
def test_what_counts_as_assigned_twice(text: str, twice: bool) -> None:
    assert any(count > 1 for count in assigned_names(text).values()) == twice
