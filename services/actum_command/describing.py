"""Describes messages in words, one line of console markup each; writes the lines of `actum watch`."""

import threading
import time
from collections.abc import Callable
from datetime import datetime

import numpy as np
from pydantic_core import to_json
from rich.console import Group
from rich.markup import escape
from rich.text import Text

from actum.codec import schema_name
from actum.messages import (
    Action,
    Agent,
    Continuation,
    Event,
    HeldBack,
    Image,
    Intent,
    Message,
    Objects,
    Posture,
    Segment,
    Skeleton,
    Status,
    TrackedObject,
    Truth,
)
from actum.node import SECOND_NS
from actum.runtime import Received
from actum.skeletons import INDEX

EPOCH_NS = 10**18  # September 2001: later stamps count from 1970, smaller ones from the start of the sensor's clock

BAR = 5  # characters of the bar that shows how much of an action has been done

STALE_S = 0.7  # an action of which nothing more is heard is over: partial ones come with every frame


def line(received: Received) -> str:
    """Describe one received message as console markup."""
    if received.message is None:
        return f"[red]{escape(received.key)} {escape(str(received.error))}[/red]"
    return f"[dim]{time_of(received.message)} {escape(received.key)}[/dim] {describe(received.message)}"


def json_line(received: Received) -> str:
    """Write one received message as JSON: key, schema and every field; or key and error where it does not decode."""
    if received.message is None:
        fields = {"key": received.key, "error": str(received.error)}
    else:
        fields = {"key": received.key, "schema": schema_name(received.message), **received.message.model_dump()}
    return to_json(fields, bytes_mode="base64", inf_nan_mode="null").decode()


def time_of(message: Message) -> str:
    """Return when a message was captured: the time of day, or seconds since the start of the sensor's clock."""
    if message.stamp_ns is None:
        return "now"
    if message.stamp_ns < EPOCH_NS:
        return f"{message.stamp_ns / SECOND_NS:.3f} s"
    return f"{datetime.fromtimestamp(message.stamp_ns / SECOND_NS):%H:%M:%S.%f}"[:-3]


def describe(message: Message) -> str:
    """Describe a message in one line; where it belongs to a segment, the line begins with that."""
    if isinstance(message, Event):
        return f"{escape(message.segment_id)}: {describe_event(message)}" if message.valid else describe_event(message)
    if isinstance(message, Action):
        return describe_action(message)
    if not message.valid:
        return f"[yellow]not valid: {escape(message.reason or '')}[/yellow]"
    return _content(message)


def describe_event(event: Event) -> str:
    """Describe an event: its sentence, or why it was rejected."""
    if not event.valid:
        return f"[yellow]{escape(event.segment_id)} rejected: {escape(event.reason or '')}[/yellow]"
    return f"[bold]{escape(event.sentence)}[/bold]"


def describe_action(action: Action) -> str:
    """Describe an action, partial or final, or why it was rejected."""
    if not action.valid:
        return f"[yellow]{escape(action.segment_id)} rejected: {escape(action.reason or '')}[/yellow]"
    kind = "final" if action.final else "so far"
    done = "" if action.completeness is None else f" {_progress(action.completeness)}"
    named = f"unknown, most like {action.action}" if action.unknown else str(action.action)
    answer = f"{escape(named)}{done} {action.confidence:.2f}, {action.frames} frames"
    return f"{escape(action.segment_id)} {kind}: {answer}"


def describe_ongoing(action: Action) -> str:
    """Describe what a person seems to be doing, how far it is where that is known, and how likely it is."""
    done = "" if action.completeness is None else f" {_progress(action.completeness)}"
    return f"[dim]agent {action.agent}: {escape(str(action.action))}{done} {action.confidence:.2f}[/dim]"


def _progress(completeness: float) -> str:
    """Write how much of an action has been done, as a number and as a bar: `62 % ▆▆▆▁▁`."""
    share = min(max(completeness, 0.0), 1.0)
    full = round(BAR * share)
    return f"{100 * share:.0f} % {'▆' * full}{'▁' * (BAR - full)}"


def _content(message: Message) -> str:
    """Describe what a valid message holds, whichever kind it is of."""
    text = message.SCHEMA
    match message:
        case Skeleton():
            text = "; ".join(map(_agent, message.agents)) or "nobody"
        case Posture():
            text = _posture(message)
        case Objects():
            text = "; ".join(map(_object, message.objects)) or "no object"
        case Image():
            text = f"{message.format} {message.width}x{message.height}, {len(message.data)} bytes"
        case Segment():
            label = "" if message.label is None else f", label {escape(message.label)}"
            origin = "" if message.origin is None else f", by {escape(message.origin)}"
            text = f"{message.kind} {escape(message.segment_id)}{label}{origin}"
        case HeldBack():
            text = f"[dim]not told: {escape(message.sentence)}[/dim]"
        case Intent():
            text = _intent(message)
        case Continuation():
            text = _continuation(message)
        case Truth():
            done = f'{message.action} {message.object_id} "{message.object_name}"'
            text = f"{message.kind} {escape(message.segment_id)}: {escape(done)}"
        case Status():
            text = f"{escape(message.state)}, {sum(message.rates.values()):.0f} messages/s"
    return text


def _intent(message: Intent) -> str:
    """Describe the likeliest contact; an intent without any ends a reach."""
    if not message.intended:
        return "[dim]the reach is over[/dim]"
    likeliest = message.intended[0]
    reach = f"reaches for {escape(likeliest.object_name)} ({likeliest.object_id}) with the {likeliest.hand} hand"
    when = f"contact in {likeliest.contact_s:.2f} s ± {likeliest.contact_std_s:.2f}"
    return f"{likeliest.soon_probability:.2f}  {reach}, {when}"


def _continuation(message: Continuation) -> str:
    """Describe where the hands are expected, in the camera frame."""
    left, right = (INDEX[name] for name in ("left_hand", "right_hand"))
    hands = [
        f"in {each.ahead_s:g} s left hand {_point(each.joints_m[left])}, right hand {_point(each.joints_m[right])}"
        for each in message.ahead
    ]
    return f"agent {message.agent}: {'; '.join(hands)}"


def _posture(message: Posture) -> str:
    """Describe the hips' position in the camera frame, and the hands' positions in the egocentric frame."""
    if message.ego_from_camera is None or message.joints_m is None:
        return f"agent {message.agent}: no joints"
    ego_from_camera = np.reshape(message.ego_from_camera, (4, 4))
    hips = -ego_from_camera[:3, :3].T @ ego_from_camera[:3, 3]
    left, right = (message.joints_m[INDEX[name]] for name in ("left_hand", "right_hand"))
    return (
        f"agent {message.agent}: hips {_point(hips.tolist())}; "
        f"from there (left, up, forward) left hand {_point(left)}, right hand {_point(right)}"
    )


def _agent(agent: Agent) -> str:
    known = sum(joint is not None for joint in agent.joints)
    return f"agent {agent.agent}: torso {_point(agent.joints[INDEX['torso']])}, {known} of {len(agent.joints)} joints"


def _object(tracked: TrackedObject) -> str:
    hidden = "" if tracked.seen else " (covered, followed)" if tracked.followed else " (hidden)"
    return f"{tracked.id} {escape(tracked.name)} {_point(tracked.position_m)}{hidden}"


def _point(position_m: list[float] | None) -> str:
    return "unknown" if position_m is None else f"({', '.join(f'{metres:.2f}' for metres in position_m)}) m"


class OngoingLines:
    """The newest partial action of each person, until its final one has come or nothing more is heard of it.

    It is fed by one thread and drawn by another.
    """

    def __init__(self, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._clock_s = clock_s
        self._newest: dict[tuple[str, int], tuple[float, Action]] = {}
        self._lock = threading.Lock()

    def receive(self, message: Message | None) -> None:
        """Note a partial action, or the end of one."""
        if not isinstance(message, Action):
            return
        person = message.sensor, message.agent
        with self._lock:
            if not message.final:
                self._newest[person] = self._clock_s(), message
            elif person in self._newest and self._newest[person][1].segment_id == message.segment_id:
                del self._newest[person]

    def __rich__(self) -> Group:
        """Return a line for each person who is doing something."""
        oldest_s = self._clock_s() - STALE_S
        with self._lock:
            self._newest = {person: (at_s, a) for person, (at_s, a) in self._newest.items() if at_s > oldest_s}
            actions = [action for _, (_, action) in sorted(self._newest.items())]
        return Group(*(Text.from_markup(describe_ongoing(action)) for action in actions))
