"""Classifiers that share sensors, of which one is killed again and again: every segment has one answer, as alone."""

import os
import random
import signal
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from itertools import chain
from pathlib import Path

from benchmarks.latency.running import STARTING_S

from actum import keys
from actum.messages import Action, Message, Posture, Segment, Skeleton
from actum.node import replay
from actum.runtime import Client, Received
from actum.settings import NodeSettings
from actum_command import processes
from actum_command.supervising import Program, Supervisor
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.model_loading import load_model

from .scenes import Answer, answer, answers, crowd

SENSORS = ("door", "window", "table", "shelf")
SETTINGS = NodeSettings(connect="tcp/127.0.0.1:7468", sensor=",".join(SENSORS))
NAMES = ("north", "south")
"""The two classifiers: by these names each has two of the sensors."""
SECONDS = 100.0
"""Length of a run (s): some 60 actions before four sensors."""
KILLS = 6
FIRST_KILL_S, BETWEEN_KILLS_S = 10.0, 14.0
"""When the first process is killed, and how long after it the next (s), by which time it has been started again."""
SETTLING_S = 10.0
"""How long answers may take after the last frame (s)."""
Heard = defaultdict[tuple[str, str], list[tuple[float, Action]]]
"""The final actions of each segment, by sensor and name, and when each was heard (s)."""
LOOK_S = 0.02
"""Interval between two looks at who serves whom (s)."""


def takeover(model: Path, seed: int = 1) -> Iterator[str]:
    """Yield what became of each segment, and how long sensors were without a classifier."""
    scenes = {sensor: crowd(sensor, 1, 20 * n, SECONDS) for n, sensor in enumerate(SENSORS)}
    expected = {sensor: answers(scene, load_model(model)) for sensor, scene in scenes.items()}
    heard: Heard = defaultdict(list)

    def hear(received: Received) -> None:
        if isinstance(received.message, Action) and received.message.final:
            segment = received.message.sensor, received.message.segment_id
            heard[segment].append((time.monotonic(), received.message))

    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(model.with_name("takeover.log")))
        programs = {name: _classifier(name, model) for name in NAMES}
        supervisor.start(processes.router(SETTINGS.of_each_sensor[0]), *programs.values())
        clients = {own.sensor: stack.enter_context(Client(own, wait_s=STARTING_S)) for own in SETTINGS.of_each_sensor}
        clients[SENSORS[0]].follow(keys.pattern(keys.ACTION), hear)
        for client in clients.values():
            assert client.wait_for_subscriber(keys.SEGMENT, STARTING_S)
        run = Run(supervisor, programs, clients, random.Random(seed))
        run.play({sensor: _postures(scene) for sensor, scene in scenes.items()})
    yield from _report(run, heard, expected)


class Run:
    """Puts what the sensors see, kills, and watches who serves."""

    def __init__(
        self,
        supervisor: Supervisor,
        programs: dict[str, Program],
        clients: dict[str, Client],
        rng: random.Random,
    ) -> None:
        self._supervisor, self._programs, self._clients, self._rng = supervisor, programs, clients, rng
        self.vacant_s: list[float] = []
        self.kills: list[tuple[float, str]] = []
        self._vacant: dict[str, tuple[str, float]] = {}

    def play(self, scenes: dict[str, list[Message]]) -> None:
        """Put the scenes as they are captured, kill meanwhile, and wait for the answers."""
        began_s = time.monotonic() + 1.0
        kills_s = [began_s + FIRST_KILL_S + n * BETWEEN_KILLS_S + self._rng.uniform(0, 1) for n in range(KILLS)]
        for message in sorted(chain(*scenes.values()), key=lambda message: message.stamp_ns or 0):
            while (left_s := began_s + (message.stamp_ns or 0) / 1e9 - time.monotonic()) > 0:
                self._look()
                if kills_s and time.monotonic() >= kills_s[0]:
                    kills_s.pop(0)
                    self._kill(self._rng.choice(NAMES))
                time.sleep(min(left_s, LOOK_S))
            self._clients[message.sensor].put(message)
        ends_s = time.monotonic() + SETTLING_S
        while time.monotonic() < ends_s:
            self._look()
            time.sleep(LOOK_S)

    def _kill(self, name: str) -> None:
        """Kill a classifier; the sensors that it serves are vacant from now on."""
        served = [sensor for sensor, client in self._clients.items() if _serving(client) == [name]]
        os.kill(self._supervisor.process_id(self._programs[name]), signal.SIGKILL)
        self.kills.append((time.monotonic(), name))
        self._vacant |= dict.fromkeys(served, (name, time.monotonic()))

    def _look(self) -> None:
        """Restart what has ended, and note which vacant sensors have a classifier again."""
        self._supervisor.restart_ended()
        for sensor, (killed, since_s) in list(self._vacant.items()):
            if set(_serving(self._clients[sensor])) - {killed}:
                self.vacant_s.append(time.monotonic() - since_s)
                del self._vacant[sensor]


def _serving(client: Client) -> list[str]:
    return [key.split("/")[-1] for key in client.alive()]


def _classifier(name: str, model: Path) -> Program:
    [program] = [each for each in processes.services(SETTINGS, model, {}) if each.name == "som_classifier"]
    return replace(program, arguments=["--share", "--instance", name, "--segments", "marks"])


def _postures(scene: list[Message]) -> list[Message]:
    """Return the postures of a scene's skeletons, and its marks."""
    node = PosePreprocessor(PoseSettings.defaults())
    skeletons = [(message.stamp_ns, message) for message in scene if isinstance(message, Skeleton)]
    postures = [each for each in replay(node, skeletons) if isinstance(each, Posture)]
    marks = [message for message in scene if isinstance(message, Segment)]
    return sorted([*postures, *marks], key=lambda message: message.stamp_ns or 0)


def _report(run: Run, heard: Heard, expected: dict[str, dict[str, Answer]]) -> Iterator[str]:
    marked = ((sensor, name, said) for sensor, each in expected.items() for name, said in each.items())
    asked = {(sensor, name): said for sensor, name, said in marked if not name.startswith("auto-")}
    differing = [key for key, said in asked.items() if [answer(action) for _, action in heard[key]] != [said]]
    twice = sum(len(said) > 1 for said in heard.values())
    yield (
        f"{len(asked)} marked segments before {len(SENSORS)} sensors, {len(NAMES)} classifiers, {KILLS} kills: "
        f"{len(asked) - len(differing)} answered once and as by one classifier that nobody kills, "
        f"{twice} answered more than once, {sum(not heard[key] for key in asked)} not answered."
    )
    if differing:
        yield "\n".join(_difference(*key, asked[key], heard[key], run.kills) for key in differing)
    vacant_s = sorted(run.vacant_s)
    yield (
        f"A sensor whose classifier was killed had another one after {vacant_s[len(vacant_s) // 2]:.2f} s "
        f"(median of {len(vacant_s)}), {vacant_s[-1]:.2f} s at the most."
    )


def _difference(
    sensor: str, name: str, said: Answer, heard: list[tuple[float, Action]], kills: list[tuple[float, str]]
) -> str:
    """Return what was answered to a segment, and when, beside what a classifier that nobody kills answers."""
    others = [f"{answer(action)}{_lasts(action)}, {_since_kill(at_s, kills)}" for at_s, action in heard]
    return f"- segment {name} of {sensor}: {said} expected; {'; '.join(others) or 'no answer'}"


def _lasts(action: Action) -> str:
    lost = f", {action.missed} frames lost" if action.missed else ""
    return f", from {action.start_ns / 1e9:.2f} to {(action.end_ns or 0) / 1e9:.2f} s{lost}"


def _since_kill(at_s: float, kills: list[tuple[float, str]]) -> str:
    before = [(killed_s, name) for killed_s, name in kills if killed_s <= at_s]
    return f"{at_s - before[-1][0]:.2f} s after {before[-1][1]} was killed" if before else "before any kill"
