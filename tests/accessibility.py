"""Faults of accessibility that axe finds in a page."""

from typing import Any


def serious_faults(page: Any) -> list[tuple[str, list[str]]]:
    """List the serious and critical faults: each rule, and the elements that break it."""
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page).response["violations"]
    serious = [fault for fault in found if fault["impact"] in ("serious", "critical")]
    return [(fault["id"], [node["html"] for node in fault["nodes"]]) for fault in serious]
