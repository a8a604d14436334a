"""The configuration of a router that is linked to the router of another host."""

from collections.abc import Mapping


def router_configuration(link: str | None) -> Mapping[str, object]:
    """Return a router's configuration: that of `actum router`, and the endpoint of the router that it links to."""
    queue = {"size": {"data_high": 16}, "congestion_control": {"drop": {"wait_before_drop": 50_000}}}
    retry = {"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}
    linked = {"endpoints": [link], "timeout_ms": -1, "exit_on_failure": False, "retry": retry}
    return {
        "mode": "router",
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {"shared_memory": {"enabled": False}, "link": {"tx": {"queue": queue}}},
        "adminspace": {"enabled": True},
        **({} if link is None else {"connect": linked}),
    }
