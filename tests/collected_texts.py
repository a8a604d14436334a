"""What the code can say: the kinds under which services count what they reject, and the reasons that messages carry.

Both are collected from the syntax of the services' sources, so that a new one without an explanation is found.
A text with a hole in it (`f"too few frames: {n}"`) is collected with `…` in the hole's place.
"""

import ast
from collections import defaultdict
from dataclasses import dataclass, field

from docs.sources import Sources

PACKAGES = (
    "shared/actum",
    "services/sensor_gateway",
    "services/scene_simulator",
    "services/pose_preprocessor",
    "services/som_classifier",
    "services/marker_tracker",
    "services/action_fusion",
    "services/model_trainer",
    "services/web_dashboard",
    "services/ros2_bridge",
    "services/actum_command/history",
)
SOURCES = Sources(PACKAGES)
REASONS = ("reason", "why", "complaint")
"""The parameters, fields and variables that hold a reason; functions whose names begin so return one."""
LOST = "CameraLostError"
"""The error that tells why a camera is lost, which follows `camera lost: ` in a reason."""


@dataclass
class Collected:
    """Texts with the places where they stand, and expressions that could not be followed."""

    texts: defaultdict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    unknown: dict[str, str] = field(default_factory=dict)

    def receive(self, node: ast.expr, place: str) -> bool:
        """Collect the texts that an expression can be; false where there are none."""
        found = list(SOURCES.texts(node))
        for text in found:
            self.texts[text].add(place)
        return bool(found)

    def take_assigned(self, name: str) -> None:
        """Collect what the variables of a name are set to."""
        for value, place in SOURCES.assigned(name):
            self.receive(value, place)


def reject_kinds() -> Collected:
    """Collect the kinds: what `reject` and errors with a `kind` are given, and what variables of that name hold."""
    found = Collected()
    found.take_assigned("kind")
    for place, name, call in SOURCES.calls():
        for given in SOURCES.arguments(call, name, "kind") if name == "reject" or name.endswith("Error") else []:
            followed = "kind" in (getattr(given, "attr", ""), getattr(given, "id", ""))
            if not found.receive(given, place) and not followed:
                found.unknown[place] = ast.unparse(call)
    return found


def reasons() -> Collected:
    """Collect the reasons: of parameters, fields, variables and functions that are called so."""
    found = Collected()
    for wanted in REASONS:
        found.take_assigned(wanted)
    for place, name, call in SOURCES.calls():
        given = [each for wanted in REASONS for each in SOURCES.arguments(call, name, wanted)]
        for each in given + (call.args if name == LOST else []):
            found.receive(each, place)
    for (name, _), returned in SOURCES.returns.items():
        for each in returned if name.strip("_").startswith("why") else []:
            found.receive(each, name)
    return found
