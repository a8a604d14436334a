"""Hosts whose wall clocks are apart, and are set while everything runs, tell the same events as others."""

import json
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pytest

import wall_clocks
from actum import keys
from actum.joining import PAUSE_NS
from actum.messages import Event, Image, Status
from actum.node import SECOND_NS
from actum.runtime import Client
from actum_command.doctor.diagnosis import EXPECTED
from actum_command.processes import simulated_objects
from live import PATIENCE_S, Running, System, collect, system
from sensors import marker_camera
from wall_clocks import WallClock

MISSING = wall_clocks.missing()
pytestmark = [pytest.mark.system, pytest.mark.skipif(MISSING is not None, reason=MISSING or "")]

ACTIONS = 5
APART_S = 5.0
STEP_S = 1.0
STEPS = (0.0, STEP_S, 0.0, -STEP_S)
"""What is added to a clock one after another: it is set forward and back by a second."""
STEADY_S = 0.7
"""How long a clock then goes on as it is (s): many steps fall into each action."""
SCENE_S = 100.0
"""Longest time for five actions, which take half a minute."""
FEW = 0.1
"""Share of frames that may be lost on a busy machine."""
MANY = 60
"""Images of a camera that are looked at: those of several seconds, in which the clock is set several times."""
RING = 1000
"""Images that are held for the test."""


@contextmanager
def stepping(*clocks: tuple[WallClock, float]) -> Iterator[None]:
    """Set clocks forward and back, each around its offset (s), until the context is left."""
    ended = threading.Event()

    def run() -> None:
        number = 0
        while not ended.wait(STEADY_S):
            number += 1
            for which, (clock, ahead_s) in enumerate(clocks):
                clock.set(ahead_s + STEPS[(number + which) % len(STEPS)])

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@dataclass
class Hosts:
    """The host of the sensor and the host that computes, each with its own router, linked, and its own wall clock."""

    camera: System
    compute: System

    def start_routers(self) -> None:
        self.camera.start_router_process()
        linked = self.compute.folder / "router.json5"
        linked.write_text(json.dumps({"mode": "router", "connect": {"endpoints": [self.camera.settings.connect]}}))
        self.compute.start(
            "actum_command", "router", "--config", str(linked), "--listen", self.compute.settings.connect
        )

    def start_services(self, model: Path) -> None:
        self.camera.start("marker_tracker")
        self.compute.start("pose_preprocessor")
        self.compute.start("som_classifier", "--model", str(model), "--segments", "marks")
        self.start_fusion()
        self.compute.start("actum_command", "scene")

    def start_fusion(self) -> Running:
        return self.compute.start("action_fusion", "--state", str(self.compute.folder / "state"))


@contextmanager
def hosts(folder: Path, camera: dict[str, str], compute: dict[str, str]) -> Iterator[Hosts]:
    with ExitStack() as opened:
        systems = []
        for name, variables in (("camera", camera), ("compute", compute)):
            (folder / name).mkdir(parents=True)
            systems.append(opened.enter_context(system(folder / name)))
            systems[-1].variables = {**variables, **simulated_objects()}
        yield Hosts(*systems)


class Scene:
    """Five marked actions before two hosts, and what they say of them."""

    def __init__(self, running: Hosts, client: Client) -> None:
        self._running, self._client = running, client
        self._events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        self._statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))

    def begin(self, model: Path) -> None:
        self._running.start_services(model)
        self._running.compute.wait_for_services(self._client, *EXPECTED[1:])
        for topic in (keys.SKELETON, keys.COLOR, keys.TRUTH, keys.SEGMENT):
            assert self._client.wait_for_subscriber(topic, PATIENCE_S)
        self._running.camera.start("scene_simulator", "--repetitions", "1")

    def restart_fusion(self) -> None:
        """Kill the fusion once it has answered, and start another, which reads what was answered and when."""
        collect(self._client.listen(keys.pattern(keys.EVENT, self._client.sensor)), Event, bool, SCENE_S)
        [fusion] = [each for each in self._running.compute.running if each.log.name.startswith("action_fusion")]
        fusion.process.kill()
        self._running.start_fusion()

    def told(self) -> list[tuple[object, ...]]:
        """Each event once, without stamps, which begin anew in each run: where it begins and ends after the first."""
        found: list[Event] = collect(
            self._events, Event, lambda found: len({event.segment_id for event in found}) >= ACTIONS, SCENE_S
        )
        began_ns = min(event.start_ns for event in found)
        return sorted(
            {
                (
                    event.segment_id.rpartition("-")[2],
                    event.reason,
                    event.action,
                    event.object.id if event.object else None,
                    event.hand,
                    event.start_ns - began_ns,
                    None if event.end_ns is None else event.end_ns - began_ns,
                )
                for event in found
            }
        )

    def share_lost(self, *topics: keys.Topic) -> list[float]:
        """Which share of each topic's messages is counted as lost on the way, by those who handle it."""
        found: list[Status] = collect(self._statuses, Status, bool)
        statuses = {status.service: status for status in found}.values()
        shares = []
        for key in (keys.key(topic, self._client.sensor) for topic in topics):
            lost = sum(status.drops.get(key, 0) for status in statuses)
            shares.append(lost / (lost + sum(status.handled.get(key, 0) for status in statuses)))
        return shares


@contextmanager
def scene(folder: Path, camera: dict[str, str], compute: dict[str, str]) -> Iterator[Scene]:
    with hosts(folder, camera, compute) as running:
        running.start_routers()
        with Client(running.compute.settings, PATIENCE_S) as client:
            yield Scene(running, client)


@pytest.mark.timeout(300)
@pytest.mark.long  # two whole systems at once
def test_hosts_ten_seconds_apart_whose_clocks_are_set_meanwhile_tell_the_same_events(
    tmp_path: Path, scene_model: Path
) -> None:
    ahead, behind = WallClock(tmp_path / "ahead", APART_S), WallClock(tmp_path / "behind", -APART_S)
    with (
        scene(tmp_path / "true", {}, {}) as usual,
        scene(tmp_path / "apart", ahead.variables, behind.variables) as apart,
        stepping((ahead, APART_S), (behind, -APART_S)),
    ):
        usual.begin(scene_model)
        apart.begin(scene_model)
        apart.restart_fusion()
        expected, told = usual.told(), apart.told()
        assert len(expected) == ACTIONS
        assert told == expected
        marks, frames = apart.share_lost(keys.SEGMENT, keys.SKELETON)
        assert (marks, frames < FEW) == (0, True), "who put a message is known whatever the clocks say"


@pytest.mark.long
def test_a_camera_goes_on_at_its_pace_while_the_clock_is_set(running: System, tmp_path: Path) -> None:
    clock = WallClock(tmp_path / "clock", 0.0)
    running.start_router()
    with running.client() as client, stepping((clock, 0.0)):
        images = client.listen(keys.pattern(keys.COLOR, client.sensor), ring=RING)
        running.variables = clock.variables
        running.start("sensor_gateway", *marker_camera(tmp_path))
        stamps_ns = [image.stamp_ns for image in collect(images, Image, lambda found: len(found) >= MANY)]
    intervals_s = [(later - earlier) / SECOND_NS for earlier, later in pairwise(stamps_ns)]
    assert min(intervals_s) > 0
    assert max(intervals_s) < PAUSE_NS / SECOND_NS + STEP_S / 2, "there is a pause before the file begins again"
