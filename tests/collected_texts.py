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
    "services/actum_model_trainer/teaching",
    "services/web_dashboard",
    "services/ros2_bridge",
    "services/actum_command/history",
)
REASONS = ("reason", "why", "complaint")
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
        for value, place in assigned(name):
            self.take(value, place)


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
    """List the parameters of the functions of each name; a class has those of its `__init__`, or else its fields."""
    found: defaultdict[str, list[list[str]]] = defaultdict(list)
    for tree in modules().values():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                found[node.name].append(_named(node))
            elif isinstance(node, ast.ClassDef):
                inits = [it for it in node.body if isinstance(it, ast.FunctionDef) and it.name == "__init__"]
                fields = [getattr(it.target, "id", "") for it in node.body if isinstance(it, ast.AnnAssign)]
                found[node.name].append(_named(inits[0]) if inits else fields)
    return found


def _named(function: ast.FunctionDef) -> list[str]:
    return [argument.arg for argument in function.args.args if argument.arg not in ("self", "cls")]


@cache
def returns() -> dict[tuple[str, bool], list[ast.expr]]:
    """List what the functions of each name return, and what the methods (True) do."""
    found: defaultdict[tuple[str, bool], list[ast.expr]] = defaultdict(list)
    for tree in modules().values():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                is_method = "self" in [argument.arg for argument in node.args.args]
                given = (it.value for it in ast.walk(node) if isinstance(it, ast.Return))
                found[node.name, is_method] += [it for it in given if it is not None]
    return found


def texts(node: ast.expr, followed: frozenset[str] = frozenset()) -> Iterator[str]:
    """Yield the texts that an expression can be, as far as they stand in it or in a function that it calls.

    Of a tuple, as of a kind with its detail, it is the first.
    """
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=parts):
            yield "".join(part.value if isinstance(part, ast.Constant) else "…" for part in parts)
        case ast.IfExp(body=one, orelse=other):
            yield from texts(one, followed)
            yield from texts(other, followed)
        case ast.BoolOp(values=values):
            for value in values:
                yield from texts(value, followed)
        case ast.Name(id=name) if name in constants():
            yield constants()[name]
        case ast.Starred(value=ast.Name(id=name)):
            for value, _ in assigned(name):
                yield from texts(value, followed)
        case ast.Tuple(elts=[first, *_]):
            yield from texts(first, followed)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name not in followed:
            for returned in returns().get((name, ast.unparse(node.func).startswith("self.")), []):
                yield from texts(returned, followed | {name})


def assigned(name: str) -> Iterator[tuple[ast.expr, str]]:
    """Yield what the variables of a name are set to, and where."""
    for path, tree in modules().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and name in [getattr(target, "id", "") for target in node.targets]:
                yield node.value, f"{path}:{node.lineno}"


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
    for (name, _), returned in returns().items():
        for each in returned if name.strip("_").startswith("why") else []:
            found.take(each, name)
    return found
