"""Delays between keys of up to two seconds change nothing: the chain's answers are the same to the last bit."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from actum.messages import Action, Agent, Continuation, Event, Image, Intent, Message, Segment, Skeleton, Truth
from actum.node import SECOND_NS
from chain import answers, by_key, continuations, delayed, foreseen
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator
from wire import without_seq

SKEW_NS = 2 * SECOND_NS
USUAL_NS = SECOND_NS // 10
"""How late objects and partial actions are at the most where everything keeps up, behind the postures (ns)."""
FRAME_NS = SECOND_NS // 30
SAMPLES = 3
BESIDE_M = np.array([0.9, 0.0, 0.6])


@dataclass(frozen=True)
class Script:
    """The scene in ten acts: someone acts alone; a second person is there, first behind, then in front; nobody is
    there for a while, and the first comes back under another number; from one frame to the next only the second is
    there, then both.
    """

    frames: list[Skeleton]

    def agents(self, i: int) -> list[Agent]:
        alone, renumbered = self._person(i, 1, 0.0), self._person(i, 3, 0.0)
        second = self._person(len(self.frames) - 1 - i, 2, 1.0)
        acts = [
            *[[alone]] * 3, *[[alone, second]] * 2, [self._person(i, 1, 1.0), self._person(i + 1, 2, 0.0)],
            [], [renumbered], [second], [renumbered, second],
        ]  # fmt: skip
        return acts[10 * i // len(self.frames)]

    def at(self, tenths: float) -> int:
        """The stamp at a share of the scene, between two frames."""
        return self.frames[int(len(self.frames) * tenths / 10)].stamp_ns + FRAME_NS // 3

    def _person(self, i: int, number: int, beside: float) -> Agent:
        agent = self.frames[min(i, len(self.frames) - 1)].agents[0]
        joints = np.array(agent.joints) + beside * BESIDE_M
        return agent.model_copy(update={"agent": number, "joints": joints.tolist()})


def mark(kind: str, segment_id: str, stamp_ns: int, agent: int | None = None) -> Segment:
    fields = {"stamp_ns": stamp_ns, "sensor": "kinect0", "kind": kind, "segment_id": segment_id, "agent": agent}
    return Segment.model_validate(fields)


def marks_of(script: Script, truths: list[Truth]) -> list[Message]:
    """The actions as they were, and segments over every change in the script, some overlapping, some mistaken."""
    spans = {
        "behind": (3.1, 4.4), "across": (2.2, 4.2), "swap": (4.6, 5.6), "leaving": (5.4, 6.3), "nobody": (6.2, 6.7),
        "renumbered": (5.2, 7.5), "back": (6.6, 7.6), "exchanged": (7.9, 9.5),
    }  # fmt: skip
    marks = [mark(t.kind, t.segment_id, t.stamp_ns) for t in truths]
    for name, (start, end) in spans.items():
        marks += [mark("start", name, script.at(start)), mark("end", name, script.at(end))]
    for agent in 1, 2, 3, 4:
        marks += [
            mark("start", f"of {agent}", script.at(4.9), agent),
            mark("end", f"of {agent}", script.at(7.2), agent),
        ]
    for frames in 0, 1, 2:
        start_ns = script.at(1.0)
        end_ns = start_ns + frames * FRAME_NS
        marks += [mark("start", f"{frames} frames", start_ns), mark("end", f"{frames} frames", end_ns)]
    marks += [mark("start", "never ended", script.at(2.0)), mark("end", "never started", script.at(3.0))]
    marks += [mark("start", "twice", script.at(0.5)), mark("start", "twice", script.at(0.5) + 1)]
    marks += [mark("end", "twice", script.at(0.9)), mark("start", "swap", script.at(9.0))]
    return sorted(marks, key=lambda m: m.stamp_ns)


@pytest.fixture(scope="module")
def streams() -> dict[str, list[Message]]:
    """Every key's messages, as put by the simulator's marks, the preprocessor and the tracker; two frames are lost."""
    simulator = Simulator(balanced_programme(1, 4)[:SAMPLES], 0, 4, start_ns=10**15, image_hz=5, tail_s=3.0)
    captured = [message for messages in simulator.frames() for message in messages]
    script = Script([m for m in captured if isinstance(m, Skeleton)])
    frames = [frame.model_copy(update={"agents": script.agents(i), "seq": i}) for i, frame in enumerate(script.frames)]
    lost = {len(frames) // 5, int(0.44 * len(frames))}
    images, truths = ([m for m in captured if isinstance(m, kind)] for kind in (Image, Truth))
    preprocessor, tracker = PosePreprocessor(PoseSettings.defaults()), MarkerTracker(Settings())
    return by_key(
        [
            *(p for i, frame in enumerate(frames) if i not in lost for p in preprocessor.handle(frame)),
            *(o for image in images for o in tracker.handle(image)),
            *marks_of(script, truths),
        ]
    )


@pytest.fixture(scope="module")
def on_time(streams: dict[str, list[Message]]) -> list[Message]:
    return answers({key: delayed(messages, [0]) for key, messages in streams.items()})


KEYS = 6
late = st.integers(0, SKEW_NS)
patient = settings(max_examples=5, suppress_health_check=list(HealthCheck))


def test_the_scene_has_everything_that_could_go_wrong(streams, on_time) -> None:
    assert sorted(streams) == [
        "actum/kinect0/objects", *(f"actum/kinect0/posture/{agent}" for agent in range(4)), "actum/kinect0/segment",
    ]  # fmt: skip
    actions = {m.segment_id: m for m in on_time if isinstance(m, Action)}
    events = [m for m in on_time if isinstance(m, Event)]
    assert len(events) == len([m for m in on_time if isinstance(m, Action)])
    assert sum(event.object is not None for event in events) >= SAMPLES
    assert {name: actions[name].agent for name in ("behind", "across", "leaving", "nobody", "back", "exchanged")} == {
        "behind": 1, "across": 1, "leaving": 2, "nobody": 0, "back": 3, "exchanged": 3,
    }  # fmt: skip
    assert sum(action.missed for action in actions.values()) >= 2
    assert {m.reason for m in on_time if not m.valid} >= {
        "no person", "end without start", "segment_id reused",
    }  # fmt: skip
    assert (actions["never ended"].reason or "").startswith("start without end: the frames ended ")


@pytest.mark.thorough
@patient
@given(delays_ns=st.lists(late, min_size=KEYS, max_size=KEYS), order=st.permutations(range(KEYS)), actions_ns=late)
@example(delays_ns=[0, 0, 0, 0, 0, SKEW_NS], order=list(range(KEYS)), actions_ns=0)
@example(delays_ns=[0, SKEW_NS, SKEW_NS, 0, 0, 0], order=list(range(KEYS)), actions_ns=0)
@example(delays_ns=[0, SKEW_NS, 0, 0, SKEW_NS, SKEW_NS], order=list(range(KEYS))[::-1], actions_ns=SKEW_NS)
@example(delays_ns=[0, 0, 0, 0, SKEW_NS, 0], order=list(range(KEYS)), actions_ns=0)
@example(delays_ns=[SKEW_NS, 0, 0, SKEW_NS, 0, 0], order=list(range(KEYS)), actions_ns=0)
def test_a_delay_of_each_key_changes_nothing(streams, on_time, delays_ns, order, actions_ns) -> None:
    keys = [sorted(streams)[i] for i in order]
    late = {key: delayed(streams[key], [delay_ns]) for key, delay_ns in zip(keys, delays_ns, strict=True)}
    assert without_seq(answers(late, actions_ns)) == without_seq(on_time)


@patient
@given(jitter_ns=st.lists(st.lists(late, min_size=1, max_size=40), min_size=KEYS, max_size=KEYS), actions_ns=late)
def test_a_delay_of_each_message_changes_nothing(streams, on_time, jitter_ns, actions_ns) -> None:
    """Order is kept within a key."""
    late = {key: delayed(streams[key], delays_ns) for key, delays_ns in zip(streams, jitter_ns, strict=True)}
    assert without_seq(answers(late, actions_ns)) == without_seq(on_time)


@pytest.fixture(scope="module")
def foreseen_on_time(streams: dict[str, list[Message]]) -> list[Message]:
    return foreseen({key: delayed(messages, [0]) for key, messages in streams.items()})


def jittered(of_key: st.SearchStrategy[int]) -> st.SearchStrategy[list[int]]:
    return st.lists(of_key, min_size=1, max_size=40)


@patient
@given(
    postures_ns=jittered(st.integers(0, USUAL_NS // 2 - 1)),
    objects_ns=jittered(st.integers(0, USUAL_NS - 1)),
    actions_ns=st.integers(0, USUAL_NS // 2),
)
def test_the_usual_delays_change_nothing_that_is_foreseen(
    streams, foreseen_on_time, postures_ns, objects_ns, actions_ns
) -> None:
    """Marks are on time: an intent names the action that is known to go on."""
    late = {
        key: delayed(messages, postures_ns if "/posture/" in key else objects_ns if "/objects" in key else [0])
        for key, messages in streams.items()
    }
    assert without_seq(foreseen(late, actions_ns)) == without_seq(foreseen_on_time)
    assert {type(message) for message in foreseen_on_time} == {Continuation, Intent}
    assert any(contact.action for m in foreseen_on_time if isinstance(m, Intent) for contact in m.intended)


@patient
@given(delays_ns=st.lists(late, min_size=KEYS, max_size=KEYS))
def test_no_delay_changes_a_continuation(streams, foreseen_on_time, delays_ns) -> None:
    late = {key: delayed(streams[key], [delay_ns]) for key, delay_ns in zip(streams, delays_ns, strict=True)}
    on_time = [message for message in foreseen_on_time if isinstance(message, Continuation)]
    assert without_seq(continuations(late)) == without_seq(on_time)
