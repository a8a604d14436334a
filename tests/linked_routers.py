"""Two hosts in processes: each has a router and a system of its own, and they share only the routers' link."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.rig.linked_router import router_configuration
from benchmarks.rig.tcp_proxy import TcpProxy

from actum.settings import ServiceSettings
from live import System, free_endpoint


@dataclass
class LinkedSystems:
    """The systems of the camera's host and of the one that computes, and the link between their routers."""

    camera: System
    compute: System
    link: TcpProxy


@contextmanager
def linked_systems(folder: Path) -> Iterator[LinkedSystems]:
    """Start two routers, of which the camera's connects to the other through a proxy."""
    systems = []
    for name in ("camera", "compute"):
        (folder / name).mkdir()
        systems.append(System(folder / name, ServiceSettings(connect=free_endpoint(), sensor="kinect0")))
    camera, compute = systems
    with TcpProxy(int(compute.settings.connect.rpartition(":")[2]), seed=1) as link:
        configuration = folder / "camera.json5"
        configuration.write_text(json.dumps(router_configuration(f"tcp/127.0.0.1:{link.port}")))
        try:
            compute.start_router_process()
            camera.start_router_process(configuration)
            yield LinkedSystems(camera, compute, link)
        finally:
            camera.stop()
            compute.stop()
