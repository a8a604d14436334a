"""Describes messages in words, one line of console markup each."""

from datetime import datetime
from functools import singledispatch

import numpy as np
from rich.markup import escape

from actum.messages import (
    Action,
    Agent,
    Event,
    Image,
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
from actum.skeletons import INDEX

EPOCH_NS = 10**18  # September 2001: later stamps count from 1970, smaller ones from the start of the sensor's clock

BAR = 5  # characters of the bar that shows how much of an action has been done


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


@singledispatch
def _content(message: Message) -> str:
    return message.SCHEMA


@_content.register
def _skeleton(message: Skeleton) -> str:
    return "; ".join(map(_agent, message.agents)) or "nobody"


@_content.register
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


@_content.register
def _objects(message: Objects) -> str:
    return "; ".join(map(_object, message.objects)) or "no object"


@_content.register
def _image(message: Image) -> str:
    return f"{message.format} {message.width}x{message.height}, {len(message.data)} bytes"


@_content.register
def _mark(message: Segment) -> str:
    label = "" if message.label is None else f", label {escape(message.label)}"
    origin = "" if message.origin is None else f", by {escape(message.origin)}"
    return f"{message.kind} {escape(message.segment_id)}{label}{origin}"


@_content.register
def _truth(message: Truth) -> str:
    done = f'{message.action} {message.object_id} "{message.object_name}"'
    return f"{message.kind} {escape(message.segment_id)}: {escape(done)}"


@_content.register
def _status(message: Status) -> str:
    return f"{escape(message.state)}, {sum(message.rates.values()):.0f} messages/s"


def _agent(agent: Agent) -> str:
    known = sum(joint is not None for joint in agent.joints)
    return f"agent {agent.agent}: torso {_point(agent.joints[INDEX['torso']])}, {known} of {len(agent.joints)} joints"


def _object(tracked: TrackedObject) -> str:
    hidden = "" if tracked.seen else " (covered, followed)" if tracked.followed else " (hidden)"
    return f"{tracked.id} {escape(tracked.name)} {_point(tracked.position_m)}{hidden}"


def _point(position_m: list[float] | None) -> str:
    return "unknown" if position_m is None else f"({', '.join(f'{metres:.2f}' for metres in position_m)}) m"
