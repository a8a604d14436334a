"""What the code can say: the kinds under which services count what they reject, and the reasons that messages carry.

Both are collected from the syntax of the services' sources, so that a new one without an explanation is found.
A text with a hole in it (`f"too few frames: {n}"`) is collected with `…` in the hole's place.
"""

import ast
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = (
    "shared/actum",
    "services/sensor_gateway",
    "services/scene_simulator",
    "services/pose_preprocessor",
    "services/som_classifier",
    "services/marker_tracker",
    "services/action_fusion",
)
REASONS = ("reason", "why")
"""The parameters, fields and variables that hold a reason; functions whose names begin so return one."""
LOST = "CameraLostError"
"""The error that tells why a camera is lost, which follows `camera lost: ` in a reason."""


@dataclass
class Collected:
    """Texts with the places where they stand, and expressions that could not be followed."""

    texts: defaultdict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    unknown: dict[str, str] = field(default_factory=dict)

    def take(self, node: ast.expr, place: str) -> bool:
        """Collect the texts that an expression can be; false where there are none."""
        found = list(texts(node))
        for text in found:
            self.texts[text].add(place)
        return bool(found)

    def take_assigned(self, name: str) -> None:
        """Collect what the variables of a name are set to."""
        for path, tree in modules().items():
            for node in ast.walk(tree):
                if isinstance(node, ast.Assign) and name in [getattr(target, "id", "") for target in node.targets]:
                    self.take(node.value, f"{path}:{node.lineno}")


@cache
def modules() -> dict[str, ast.Module]:
    """Parse every module of the services and of the library, by its path."""
    files = [file for package in PACKAGES for file in sorted((ROOT / package).rglob("*.py"))]
    return {str(file.relative_to(ROOT)): ast.parse(file.read_text()) for file in files}


@cache
def constants() -> dict[str, str]:
    """List the module-level text constants by name."""
    return {
        target.id: node.value.value
        for tree in modules().values()
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


@cache
def parameters() -> dict[str, list[list[str]]]:
    """List the parameters of the functions of each name; a class has those of its `__init__`."""
    found: dict[str, list[list[str]]] = {}
    for tree in modules().values():
        for node in ast.walk(tree):
            inner = node.body if isinstance(node, ast.ClassDef) else []
            for function in [node, *inner]:
                if isinstance(function, ast.FunctionDef) and (function is node or function.name == "__init__"):
                    name = getattr(node, "name", "")
                    named = [argument.arg for argument in function.args.args if argument.arg not in ("self", "cls")]
                    found.setdefault(name, []).append(named)
    return found


@cache
def returns() -> dict[str, list[ast.expr]]:
    """List what every function returns, where that is not what another one returns."""
    found: dict[str, list[ast.expr]] = {}
    for tree in modules().values():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                given = [it.value for it in ast.walk(node) if isinstance(it, ast.Return) and it.value is not None]
                found.setdefault(node.name, []).extend(it for it in given if not isinstance(it, ast.Call))
    return found


def texts(node: ast.expr) -> Iterator[str]:
    """Yield the texts that an expression can be, as far as they stand in it."""
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=parts):
            yield "".join(part.value if isinstance(part, ast.Constant) else "…" for part in parts)
        case ast.IfExp(body=one, orelse=other):
            yield from texts(one)
            yield from texts(other)
        case ast.BoolOp(values=values):
            for value in values:
                yield from texts(value)
        case ast.Name(id=name) if name in constants():
            yield constants()[name]
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            for returned in returns().get(name, []):
                yield from texts(returned)


def calls() -> Iterator[tuple[str, str, ast.Call]]:
    """Yield every call: where it stands, the name called, the call."""
    for path, tree in modules().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call):
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                yield f"{path}:{node.lineno}", name, node


def arguments(call: ast.Call, name: str, wanted: str) -> list[ast.expr]:
    """Find what a call may give for a parameter, by keyword or by place."""
    by_place = [named.index(wanted) for named in parameters().get(name, []) if wanted in named]
    by_keyword = [keyword.value for keyword in call.keywords if keyword.arg == wanted]
    return by_keyword + [call.args[place] for place in set(by_place) if place < len(call.args)]


def reject_kinds() -> Collected:
    """Collect the kinds: what `reject` and errors with a `kind` are given, and what variables of that name hold."""
    found = Collected()
    found.take_assigned("kind")
    for place, name, call in calls():
        for given in arguments(call, name, "kind") if name == "reject" or name.endswith("Error") else []:
            followed = "kind" in (getattr(given, "attr", ""), getattr(given, "id", ""))
            if not found.take(given, place) and not followed:
                found.unknown[place] = ast.unparse(call)
    return found


def reasons() -> Collected:
    """Collect the reasons: of parameters, fields, variables and functions that are called so."""
    found = Collected()
    for wanted in REASONS:
        found.take_assigned(wanted)
    for place, name, call in calls():
        given = [each for wanted in REASONS for each in arguments(call, name, wanted)]
        for each in given + (call.args if name == LOST else []):
            found.take(each, place)
    for name, returned in returns().items():
        for each in returned if name.strip("_").startswith("why") else []:
            found.take(each, name)
    return found
