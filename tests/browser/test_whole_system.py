"""The page of live processes: it outlives their router, and its own service."""

from collections.abc import Callable
from typing import Any

import pytest

from live import System, free_endpoint, wait_until
from page_scenes import wait_for_state

pytestmark = [pytest.mark.browser, pytest.mark.system, pytest.mark.long]


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
