"""Where the embedded router listens: on this machine alone, unless it is told otherwise."""

import json
from pathlib import Path

import pytest

from actum.runtime.router import router_config
from actum.settings import DEFAULT_ENDPOINT

ELSEWHERE = "tcp/192.0.2.1:7500"


@pytest.mark.parametrize(
    ("content", "listen", "endpoints"),
    [
        ("{}", None, [DEFAULT_ENDPOINT]),
        ('{mode: "router", scouting: {multicast: {enabled: false}}}', None, [DEFAULT_ENDPOINT]),
        ("{listen: {timeout_ms: 1}}", None, [DEFAULT_ENDPOINT]),
        (f'{{listen: {{endpoints: ["{ELSEWHERE}"]}}}}', None, [ELSEWHERE]),
        ("{}", ELSEWHERE, [ELSEWHERE]),
    ],
)
def test_a_file_that_names_no_endpoint_opens_no_port_to_the_network(
    content: str, listen: str | None, endpoints: list[str], tmp_path: Path
) -> None:
    file = tmp_path / "router.json5"
    file.write_text(content)
    assert json.loads(router_config(listen, file).get_json("listen/endpoints")) == endpoints
