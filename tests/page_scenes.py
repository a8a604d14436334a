"""Somebody before a camera as the page sees it, in real time, without a router."""

import threading
import time
from collections.abc import Iterator
from typing import Any

from actum.messages import (
    Action,
    Continuation,
    Intended,
    Message,
    Objects,
    PostureAhead,
    Skeleton,
    Status,
    TrackedObject,
)
from actum.node import SECOND_NS, Tick
from dashboards import Served
from empty_messages import contact, intent
from events import event
from live import wait_until
from node_cases import photograph
from people import FRAME_NS, reaches
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings

LABELS = ("lift", "push", "wave")


class Scene:
    """Somebody who reaches for the cup again and again, in real time, with services that report."""

    def __init__(self, page: Served) -> None:
        self.page = page
        self.still = False
        self.contact: Intended | None = None
        self.rises_m: float | None = None
        self.stamp_ns = 1_700_000_000_000_000_000
        self._preprocessor = PosePreprocessor(PoseSettings.defaults())
        self._frames = reaches(60)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._play, daemon=True)

    def __enter__(self) -> "Scene":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def _play(self) -> None:
        number = 0
        while not self._stop.wait(1 / 30):
            self.stamp_ns += FRAME_NS
            self.page.give(*self._instant(number))
            number += 1

    def _instant(self, number: int) -> Iterator[Message]:
        pose = 0 if self.still else number % len(self._frames)
        frame = self._frames[pose].model_copy(update={"stamp_ns": self.stamp_ns, "seq": number, "session_id": ""})
        yield frame
        yield from (output for output in self._preprocessor.handle(frame) if isinstance(output, Message))
        if (expected := self.contact) is not None:
            yield intent(self.stamp_ns, expected, segment_id="one")
        if self.rises_m is not None:
            yield risen(frame, self.rises_m)
        if number % 2 == 0:
            yield photograph(self.stamp_ns)
            yield objects(self.stamp_ns, 0.1 * pose / len(self._frames))
        if number % 30 == 0:
            for name in ("sensor_gateway", "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion"):
                yield status(name, self.stamp_ns)

    def go_on(self, seconds: float) -> None:
        """Let some time of the scene pass."""
        until_ns = self.stamp_ns + int(seconds * SECOND_NS)
        wait_until(lambda: self.stamp_ns >= until_ns, "the scene goes on")

    def reach(self, probability: float, contact_s: float) -> None:
        """From now on put with each frame that the person, in the segment `one`, is about to touch the cup."""
        self.contact = contact(probability, contact_s=contact_s)

    def end_reach(self, silently: bool) -> None:
        """Put such intents no more: first an empty one, unless the person is lost from view."""
        self.contact = None
        if not silently:
            self.page.give(intent(self.stamp_ns))

    def measured(self) -> set[str]:
        """Put the status of the page's service; return the messages of which it has measured the time."""
        node = self.page.node
        node.handle(Tick(time.monotonic_ns()))
        self.page.give(status(node.name, self.stamp_ns).model_copy(update={"hops": node.counters.hops}))
        return {hop.effect for hop in node.counters.hops}

    def rise(self, rises_m: float | None) -> None:
        """From now on expect with each frame that all joints rise so far in half a second; None: expect nothing."""
        self.rises_m = rises_m

    def answer(self, segment_id: str, sentence: str, confidence: float = 0.9) -> None:
        """Put an early answer, a final action and the event of one segment that ends now."""
        times = {"stamp_ns": self.stamp_ns, "start_ns": self.stamp_ns - SECOND_NS // 2, "end_ns": self.stamp_ns}
        told = event(segment_id, sentence).model_copy(
            update={**times, "confidence": confidence, "activations": activations()}
        )
        self.page.give(
            action(segment_id, times | {"end_ns": None}, final=False), action(segment_id, times, final=True), told
        )


def activations() -> dict[str, float]:
    return {"lift": -0.2, "push": 0.8, "wave": 0.1}


def action(segment_id: str, times: dict[str, Any], final: bool) -> Action:
    return Action(
        **times, sensor="kinect0", agent=1, segment_id=segment_id, final=final, action="push", confidence=0.7,
        activations=activations(), part="right_arm", frames=40, missed=0, familiarity=0.8 if final else None,
    )  # fmt: skip


def risen(frame: Skeleton, rises_m: float) -> Continuation:
    """Expect the person of a frame so much higher half a second later."""
    joints = [joint and [joint[0], joint[1] - rises_m, joint[2]] for joint in frame.agents[0].joints]
    return Continuation(
        stamp_ns=frame.stamp_ns, sensor=frame.sensor, agent=1, ahead=[PostureAhead(ahead_s=0.5, joints_m=joints)],
        session_id=frame.session_id,
    )  # fmt: skip


def objects(stamp_ns: int, along_m: float) -> Objects:
    cup = TrackedObject(
        id=1, name="cup", position_m=[along_m, 0.1, 2.0], quaternion_xyzw=[0, 0, 0, 1], confidence=1.0, seen=True
    )
    return Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=[cup])


def status(name: str, stamp_ns: int) -> Status:
    return Status(
        stamp_ns=stamp_ns, sensor="kinect0", service=name, instance="x", uptime_s=3.0, handled={}, drops={}, rejects={},
        rates={"actum/kinect0/skeleton": 30.0}, last_error=None, latency_ms={"p50": 1.0, "p99": 2.0}, state="running",
    )  # fmt: skip


def maps(_service: str, command: str, **_fields: Any) -> dict[str, Any]:
    """Answer as a classifier with small maps."""
    assert command == "maps"
    body = [
        [0.0, 0.4, 0.0],
        [0.0, 0.2, 0.0],
        [0.0, 0.0, 0.0],
        *[[0.1 * side, -0.1 * i, 0.0] for side in (1, -1) for i in range(6)],
    ]
    return {
        "model": "0123456789ab",
        "posture_map": {"rows": 3, "columns": 4, "bodies": [body] * 12},
        "action_map": {"rows": 2, "columns": 3, "labels": [*LABELS, *LABELS]},
    }


def wait_for_state(page: Any, text: str) -> None:
    page.wait_for_function(
        "text => document.getElementById('state').textContent.includes(text)", arg=text, timeout=60_000
    )
