"""Pointing: the action is applied to the object nearest to the ray of the actor's stretched arm."""

import math
from collections.abc import Sequence

import numpy as np

from action_fusion.choice.evidence import NO_HAND, OFF_THE_LINE, Choice, Evidence
from action_fusion.tracks.actors import Actor
from action_fusion.tracks.comotion import FURTHEST_SHARE
from actum.arrays import Array, median
from actum.messages import Hand, Pointing

HOLDING_SHARE = 1 / 3
"""Last share of a pointing action before the way back, in which the arm is stretched out."""

POINTING_M = 0.08
"""Largest distance of the ray's tip from its median in that last share while the arm is out: thrice a joint's noise."""

FINGER_M = 0.10
"""Distance from the hand joint to the tip of the stretched index finger, along the line of the forearm."""

CLEARLY = 0.5
"""Ratio of angles below which one ray fits an object clearly better than another."""

SMALLEST_M = 1e-9
"""Least divisor: shorter vectors have no direction."""


def pointed_at(evidence: Evidence) -> Choice:
    """Choose the object at the smallest angle to the pointing ray; objects at nearly the same angle are rivals."""
    settings, side = evidence.settings, pointing_side(evidence.actor, evidence.sides)
    by_angle = zip(_angles(evidence.objects_ego, evidence.actor, side), evidence.tracks, strict=True)
    ranked = sorted((one for one in by_angle if math.isfinite(one[0])), key=lambda one: one[0])
    if not ranked:
        return Choice(why=NO_HAND)
    angles = [math.degrees(angle) for angle, _ in ranked]
    if angles[0] > settings.pointing_limit_deg:
        return Choice(why=OFF_THE_LINE)
    limit = min(angles[0] + settings.pointing_uncertainty_deg, settings.pointing_limit_deg)
    rivals = tuple(track for angle, (_, track) in zip(angles[1:], ranked[1:], strict=True) if angle <= limit)
    margin = angles[1] - angles[0] if len(angles) > 1 else None
    return Choice(ranked[0][1], (side,), None, rivals, Pointing(angle_deg=angles[0], margin_deg=margin))


def pointing_side(actor: Actor, sides: Sequence[Hand]) -> Hand:
    """Return the hand whose finger is furthest from the line of hips and head, by the median over the last share."""
    return max(sides, key=lambda side: _outstretched_m(actor, side))


def fingertip_m(actor: Actor, side: Hand) -> Array:
    """Return the tip (p, 3) of the hand's stretched index finger, egocentric."""
    elbow, hand = actor.joint_m(f"{side}_elbow"), actor.hand_m(side)
    forearm = hand - elbow
    length = np.linalg.norm(forearm, axis=1, keepdims=True)
    tip: Array = hand + FINGER_M * forearm / np.maximum(length, SMALLEST_M)
    return tip


def pointing_angles(objects_ego: Array, tip_ego: Array, origin_ego: Array) -> list[float]:
    """Compute the angles (rad) between the median rays from origin to tip and to objects, while the arm is out.

    The objects are (objects, p, 3), tip and origin (p, 3), in metres in the actor's egocentric frame, NaN where
    unknown. The angles are infinite where origin and tip are never known together.
    """
    known = np.flatnonzero(np.isfinite(tip_ego + origin_ego).all(axis=1))
    if not len(known):
        return [np.inf] * len(objects_ego)
    to_tip = tip_ego[known] - origin_ego[known]
    last = median(to_tip[_holding(to_tip)])
    out = np.linalg.norm(to_tip - last, axis=1) <= POINTING_M
    counted = known[out] if out.any() else known[-1:]
    ray = median(to_tip[out]) if out.any() else last
    to_objects = median((objects_ego[:, counted] - origin_ego[counted]).swapaxes(0, 1))
    return [_angle(ray, to_object) for to_object in to_objects]


def _angle(one: Array, other: Array) -> float:
    """Compute the angle (rad) between two vectors (3,)."""
    length = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(np.arccos(np.clip(one @ other / max(length, SMALLEST_M), -1.0, 1.0)))


def _angles(objects_ego: Array, actor: Actor, side: Hand) -> list[float]:
    """Measure each object's angle to the ray from head to finger, or to that of the arm if that fits clearly better.

    Most people point along the line of sight over the finger, some along the stretched arm.
    """
    head, tip = actor.joint_m("head"), fingertip_m(actor, side)
    shoulder, hand = actor.joint_m(f"{side}_shoulder"), actor.hand_m(side)
    by_eye, by_arm = pointing_angles(objects_ego, tip, head), pointing_angles(objects_ego, hand, shoulder)
    arm_fits = math.isfinite(min(by_eye)) and min(by_arm) < CLEARLY * min(by_eye)
    return by_arm if arm_fits else by_eye


def _outstretched_m(actor: Actor, side: Hand) -> float:
    """Measure how far the finger is from the line of hips and head; minus infinity where it is never known."""
    tip, head = fingertip_m(actor, side), actor.joint_m("head")
    known = np.flatnonzero(np.isfinite(tip + head).all(axis=1))
    if not len(known):
        return -np.inf
    last = known[_holding((tip - head)[known])]
    aside = np.linalg.norm(np.cross(tip[last], head[last]), axis=1)
    return float(median(aside / np.maximum(np.linalg.norm(head[last], axis=1), SMALLEST_M)))


def _holding(to_tip: Array) -> slice:
    """Select the last third of the rays (n, 3) up to the way back, at least one: there the arm is stretched out.

    The way back begins after the last ray whose tip is about as far from its first place as it ever is.
    """
    away_m = np.linalg.norm(to_tip - to_tip[0], axis=1)
    until = int(np.flatnonzero(away_m >= FURTHEST_SHARE * away_m.max())[-1]) + 1
    return slice(until - max(1, round(until * HOLDING_SHARE)), until)
