"""Latency per hop beside a bare Zenoh chain and behind routers that ask, and throughput."""
