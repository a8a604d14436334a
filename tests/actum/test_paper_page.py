"""The page that goes through the paper names what there is."""

import re
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "paper.md"
OURS = "actum|action_fusion|marker_tracker|actum_model_trainer|pose_preprocessor|sensor_gateway|som_classifier"
NAMES = sorted(set(re.findall(rf"`((?:{OURS})\.[\w.]+)`", PAGE.read_text(encoding="utf-8"))))


def test_names_are_found_on_the_page() -> None:
    assert len(NAMES) > 10


@pytest.mark.parametrize("name", NAMES)
def test_a_name_on_the_page_exists(name: str) -> None:
    module, rest = name, []
    while not _is_module(module):
        module, _, attribute = module.rpartition(".")
        rest.insert(0, attribute)
    found = import_module(module)
    for attribute in rest:
        found = getattr(found, attribute)


def _is_module(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ModuleNotFoundError:
        return False
