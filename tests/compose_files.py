"""The container files, read as Compose reads them."""

import subprocess
from ipaddress import ip_network
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


def gateway_of_bridge() -> str:
    """The engine's host as its containers see it: the bridge's first address, which not every engine names."""
    command = ["docker", "network", "inspect", "bridge", "--format", "{{(index .IPAM.Config 0).Subnet}}"]
    subnet = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
    return str(next(ip_network(subnet).hosts()))
