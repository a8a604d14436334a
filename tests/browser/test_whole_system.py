"""The page of live processes: it outlives their router, and its own service."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from live import System, free_endpoint, system, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.system, pytest.mark.long]


@pytest.fixture
def running(tmp_path: Path) -> Iterator[System]:
    with system(tmp_path) as made:
        yield made


def wait_for_state(page: Any, text: str) -> None:
    page.wait_for_function(
        "text => document.getElementById('state').textContent.includes(text)", arg=text, timeout=60_000
    )


def test_it_waits_for_router_and_sensor_and_comes_back_after_each(
    running: System, open_page: Callable[..., Any]
) -> None:
    port = free_endpoint().rpartition(":")[2]
    dashboard = running.start("web_dashboard", "--page-port", port)
    wait_until(lambda: f"http://127.0.0.1:{port}/" in dashboard.said(), "it says where the page is")
    page = open_page(f"http://127.0.0.1:{port}/")
    wait_for_state(page, f"Waiting for the router at {running.settings.connect}")
    router = running.start_router_process()
    wait_for_state(page, "Waiting for a sensor")
    running.start("scene_simulator")
    wait_for_state(page, "Waiting for pose_preprocessor, som_classifier, marker_tracker, action_fusion")
    router.process.kill()
    router.process.wait()
    wait_for_state(page, "Waiting for the router")
    running.start_router_process()
    wait_for_state(page, "Waiting for pose_preprocessor")
    dashboard.terminate()
    wait_for_state(page, "Waiting for web_dashboard")
    running.start("web_dashboard", "--page-port", port)
    wait_for_state(page, "Waiting for pose_preprocessor")
