"""The syntax of the sources, and the texts that its expressions can be.

In a text with a hole (`f"too few frames: {n}"`), the result of `hole` for the expression takes the hole's place.
"""

import ast
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from pathlib import Path

ROOT = Path(__file__).parents[1]


class Sources:
    """The parsed modules of some packages, given as folders of the repository."""

    def __init__(self, packages: Sequence[str], hole: Callable[[ast.expr], str] = lambda _: "…") -> None:
        files = [file for package in packages for file in sorted((ROOT / package).rglob("*.py"))]
        self.modules = {str(file.relative_to(ROOT)): ast.parse(file.read_text(encoding="utf-8")) for file in files}
        self._hole = hole

    def nodes(self) -> Iterator[tuple[str, ast.AST]]:
        """Yield every node of every module, with the path of its module."""
        for path, tree in self.modules.items():
            for node in ast.walk(tree):
                yield path, node

    @cached_property
    def constants(self) -> dict[str, str]:
        """The module-level text constants, by name."""
        return {name: text for path in self.modules for name, text in self._defined(path).items()}

    def constants_of(self, path: str) -> dict[str, str]:
        """Return the text constants that one module defines or imports, by name."""
        imported = {
            alias.name: constants[alias.name]
            for node in self.modules[path].body
            if isinstance(node, ast.ImportFrom)
            for module in (
                f"{package}/{(node.module or '').replace('.', '/')}.py" for package in ("shared", "services")
            )
            if (constants := self._defined(module) if module in self.modules else {})
            for alias in node.names
            if alias.name in constants
        }
        return imported | self._defined(path)

    def _defined(self, path: str) -> dict[str, str]:
        return {
            target.id: node.value.value
            for node in self.modules[path].body
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
            if isinstance(node.value.value, str)
            for target in node.targets
            if isinstance(target, ast.Name)
        }

    @cached_property
    def parameters(self) -> dict[str, list[list[str]]]:
        """The parameters of the functions of each name; a class has those of its `__init__`, or else its fields."""
        found: defaultdict[str, list[list[str]]] = defaultdict(list)
        for _, node in self.nodes():
            if isinstance(node, ast.FunctionDef):
                found[node.name].append(_named(node))
            elif isinstance(node, ast.ClassDef):
                inits = [it for it in node.body if isinstance(it, ast.FunctionDef) and it.name == "__init__"]
                fields = [getattr(it.target, "id", "") for it in node.body if isinstance(it, ast.AnnAssign)]
                found[node.name].append(_named(inits[0]) if inits else fields)
        return found

    @cached_property
    def returns(self) -> dict[tuple[str, bool], list[ast.expr]]:
        """The values that the functions of each name return; those of methods under True."""
        found: defaultdict[tuple[str, bool], list[ast.expr]] = defaultdict(list)
        for _, node in self.nodes():
            if isinstance(node, ast.FunctionDef):
                is_method = "self" in [argument.arg for argument in node.args.args]
                given = (it.value for it in ast.walk(node) if isinstance(it, ast.Return))
                found[node.name, is_method] += [it for it in given if it is not None]
        return found

    def texts(self, node: ast.expr, followed: frozenset[str] = frozenset()) -> Iterator[str]:
        """Yield the texts that an expression can be, as far as they stand in it or in a function that it calls.

        A tuple, such as a kind with its detail, stands for its first element.
        """
        match node:
            case ast.Constant(value=str(text)):
                yield text
            case ast.JoinedStr(values=parts):
                yield "".join(str(part.value) if isinstance(part, ast.Constant) else self._hole(part) for part in parts)
            case ast.IfExp(body=one, orelse=other):
                yield from self.texts(one, followed)
                yield from self.texts(other, followed)
            case ast.BoolOp(values=values):
                for value in values:
                    yield from self.texts(value, followed)
            case ast.Name(id=name) if name in self.constants:
                yield self.constants[name]
            case ast.Starred(value=ast.Name(id=name)):
                for value, _ in self.assigned(name):
                    yield from self.texts(value, followed)
            case ast.Tuple(elts=[first, *_]):
                yield from self.texts(first, followed)
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name not in followed:
                for returned in self.returns.get((name, ast.unparse(node.func).startswith("self.")), []):
                    yield from self.texts(returned, followed | {name})

    def assigned(self, name: str) -> Iterator[tuple[ast.expr, str]]:
        """Yield the values that variables of a name are set to, each with its place."""
        for path, node in self.nodes():
            if isinstance(node, ast.Assign) and name in [getattr(target, "id", "") for target in node.targets]:
                yield node.value, f"{path}:{node.lineno}"

    def calls(self) -> Iterator[tuple[str, str, ast.Call]]:
        """Yield every call: its place, the name called, the call."""
        for path, node in self.nodes():
            if isinstance(node, ast.Call):
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                yield f"{path}:{node.lineno}", name, node

    def arguments(self, call: ast.Call, name: str, wanted: str) -> list[ast.expr]:
        """Find the values that a call may give for a parameter, by keyword or by place."""
        by_place = [named.index(wanted) for named in self.parameters.get(name, []) if wanted in named]
        by_keyword = [keyword.value for keyword in call.keywords if keyword.arg == wanted]
        return by_keyword + [call.args[place] for place in set(by_place) if place < len(call.args)]


def _named(function: ast.FunctionDef) -> list[str]:
    return [argument.arg for argument in function.args.args if argument.arg not in ("self", "cls")]
