"""The container files, read as Compose reads them."""

from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).parents[1]
MAIN = ROOT / "docker-compose.yml"
DEPLOY = ROOT / "deploy"


class _Loader(yaml.SafeLoader):
    """YAML with Compose's own tags, `!reset` and `!override`, which replace instead of merging."""


def _untagged(loader: yaml.SafeLoader, _tag: str, node: yaml.Node) -> Any:
    return loader.construct_sequence(node) if isinstance(node, yaml.SequenceNode) else None


_Loader.add_multi_constructor("!", _untagged)


def services_of(file: Path) -> dict[str, dict[str, Any]]:
    return yaml.load(file.read_text(), _Loader)["services"]
