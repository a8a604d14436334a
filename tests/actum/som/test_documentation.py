"""The examples in the library's docstrings run, and every public class and function has one."""

import doctest
import importlib
import inspect
import pkgutil
from pathlib import Path

import pytest

import actum.som

MODULES = ["actum.som", *(f"actum.som.{module.name}" for module in pkgutil.iter_modules(actum.som.__path__))]
PUBLIC = {name: getattr(actum.som, name) for name in actum.som.__all__}


@pytest.mark.parametrize("name", MODULES)
def test_the_examples_of_the_documentation_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(name)
    tried = doctest.testmod(module)
    assert tried.failed == 0
    assert tried.attempted > 0 or name != "actum.som"


@pytest.mark.parametrize("name", [name for name, it in PUBLIC.items() if inspect.isclass(it) or inspect.isroutine(it)])
def test_every_public_class_and_function_shows_an_example(name: str) -> None:
    assert ">>> " in inspect.getdoc(PUBLIC[name])
