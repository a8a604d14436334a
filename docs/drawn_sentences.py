"""`python -m docs.drawn_sentences`: errors, helps and paragraphs drawn at random, to be read by a newcomer."""

import argparse
import ast
import random
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import typer
from docs.generate.pages import PAGES, PART
from docs.sources import Sources

from actum.command_line import explained, placeholder
from actum_command.__main__ import app
from actum_command.service_settings import SETTINGS

PACKAGES = ("shared/actum", "services")
REFUSING = ("fail", "warning", "error", "critical", "exception")
"""The functions and the logger's methods that print what went wrong."""
FINDINGS = ("diagnosis", "service_checks", "stream_checks", "obstacles", "tls_faults", "advice")
"""The modules whose functions yield or return what is wrong."""
FUNCTIONS = ("join", "split", "any", "map", "str", "sorted", "getattr")
"""Functions whose names do not say what they are applied to, so that a hole gets the name of that."""
FEWEST_WORDS = 3  # a shorter text frames another one, such as `{path}: {problem}`
DRAWN = {"errors": 15, "helps": 20, "paragraphs": 10}
"""The number of texts of each kind that are drawn."""


def errors() -> set[str]:
    """Collect the texts of errors, warnings and findings; a name in braces stands for a value."""
    sources: Sources = Sources(PACKAGES, lambda part: _hole(part, constants))
    constants = _unambiguous(sources)
    found: set[str] = set()
    named = {path: sources.constants_of(path) for path in sources.modules}
    for path, node in sources.nodes():
        expressions = _expressions(node, Path(path).stem in FINDINGS)
        parts = [[text] if (text := named[path].get(ast.unparse(it))) else [*sources.texts(it)] for it in expressions]
        found.update(": ".join(chosen) for chosen in product(*filter(None, parts)))  # such as a problem and its remedy
    return {text for text in found if len(re.findall(r"\b[a-z]+", re.sub(r"{[^}]*}", "", text))) >= FEWEST_WORDS}


def _expressions(node: ast.AST, finding: bool) -> list[ast.expr]:
    """Return the expressions of a statement or call that hold what went wrong."""
    match node:
        case ast.Raise(exc=ast.Call(func=raised, args=given)):
            return [] if ast.unparse(raised) == "AssertionError" else given  # a bug's words are for its author
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name), args=given) if name in REFUSING:
            return given
        case ast.Return(value=ast.expr() as value) | ast.Yield(value=ast.expr() as value) if finding:
            return [value]
        case _:
            return []


def _unambiguous(sources: Sources) -> dict[str, str]:
    """Return the text constants whose names stand in one module only."""
    named = Counter(
        getattr(target, "id", "")
        for tree in sources.modules.values()
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
    )
    return {name: text for name, text in sources.constants.items() if named[name] == 1}


def _hole(part: ast.expr, constants: Mapping[str, str]) -> str:
    """Return a constant that fills a text's hole; or, in braces, a calculation, or another expression's last name."""
    match part:
        case ast.FormattedValue(value=ast.BinOp() as calculation) | (ast.BinOp() as calculation):
            return "{" + ast.unparse(calculation) + "}"
    named = (getattr(node, "attr", getattr(node, "id", "")) for node in ast.walk(part))
    names = [name for name in named if name not in FUNCTIONS]
    if len(names) > 1 and names[1] in constants:
        return constants[names[1]]
    return "{" + next((name.strip("_") for name in names if name), "…") + "}"


def helps() -> set[str]:
    """Collect the helps of all commands, arguments, options and settings, each behind its name."""
    found = set(_of_command(typer.main.get_command(app), "actum"))
    for service, settings in SETTINGS.items():
        for name, field in settings.model_fields.items():
            flag = f"--{name.replace('_', '-')} {placeholder(field)}".rstrip()
            found.add(f"python -m {service} {flag}: {explained(field)}")
    return found


def _of_command(command: Any, path: str) -> Iterator[str]:
    """Yield the helps of a Click command, of its parameters and of its own commands."""
    yield f"{path}: {' '.join((command.help or '').split())}"
    for parameter in command.params:
        if text := getattr(parameter, "help", None):
            shown = (
                parameter.opts[-1]
                if parameter.param_type_name == "option"
                else (parameter.metavar or parameter.name.upper())
            )
            yield f"{path} {shown}: {text}"
    for name, each in getattr(command, "commands", {}).items():
        yield from _of_command(each, f"{path} {name}")


def paragraphs() -> set[str]:
    """Collect the paragraphs and lists of the pages with their headings, without tables, code and generated parts."""
    found: set[str] = set()
    for page in PAGES:
        text = re.sub(r"```.*?```|<!--.*?-->", "", PART.sub("", page.read_text(encoding="utf-8")), flags=re.S)
        heading = ""
        for block in re.split(r"\n\s*\n", text):
            if block.startswith("#"):
                heading = block.lstrip("# ")
            elif not block.startswith(("|", "!", "<")) and len(block.split()) > FEWEST_WORDS:
                found.add(f"[{page.name}: {heading}] {' '.join(block.split())}")
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Print as many of each kind as `DRAWN` gives, and the seed that draws them again."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=random.randrange(1000), help="seed; the same seed draws the same")
    seed = parser.parse_args(arguments).seed
    draw = random.Random(seed)
    print(f"seed {seed}")
    for kind, texts in (("errors", errors()), ("helps", helps()), ("paragraphs", paragraphs())):
        print(f"\n{kind}: {DRAWN[kind]} of {len(texts)}\n")
        for number, text in enumerate(draw.sample(sorted(texts), DRAWN[kind]), 1):
            print(f"{number:2}. {' '.join(text.split())}")


if __name__ == "__main__":
    main()
