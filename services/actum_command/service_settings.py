"""The settings of the services that commands start, and how they are handed on to them."""

from collections.abc import Mapping

import action_fusion.settings
import actum_command.history.settings
import marker_tracker.settings
import model_trainer.settings
import pose_preprocessor.settings
import ros2_bridge.settings
import scene_simulator.settings
import sensor_gateway.settings
import som_classifier.settings
import web_dashboard.settings
from actum.settings import ServiceSettings

TRAINER = "model_trainer"
"""The service of the package `actum_model_trainer`, which is a library besides."""

DECLARED: Mapping[str, type[ServiceSettings]] = {
    **{
        service.__name__: service.settings.Settings
        for service in (
            sensor_gateway, scene_simulator, pose_preprocessor, som_classifier, marker_tracker, action_fusion,
            web_dashboard,
        )
    },
    TRAINER: model_trainer.settings.Settings,
}  # fmt: skip
"""The settings of each service that `actum up` starts, by the service's name."""

BRIDGE = ros2_bridge.__name__
"""The service that `actum ros2` starts."""

HISTORY = "event_recorder"
"""The service that `actum record --events` is."""

SETTINGS: Mapping[str, type[ServiceSettings]] = {
    **DECLARED,
    BRIDGE: ros2_bridge.settings.Settings,
    HISTORY: actum_command.history.settings.Settings,
}
"""The settings of every service, by the service's name."""

SET_BY_UP = ("original_model",)
"""Settings that are no flags of `actum up`: it sets them by its own."""

Given = Mapping[str, bool | list[str]]
"""The settings that are given on the command line, by name."""


def arguments_of(service: str, given: Given) -> list[str]:
    """Return the flags of a service for those of the given settings that it has."""
    arguments: list[str] = []
    for name, value in given.items():
        if name not in SETTINGS[service].model_fields:
            continue
        if isinstance(value, bool):
            arguments.append(flag_of(name) if value else negated_flag_of(name))
        else:
            arguments += [f"{flag_of(name)}={text}" for text in value]
    return arguments


def flag_of(name: str) -> str:
    """Write a setting's name as a flag: `--camera-size`."""
    return f"--{name.replace('_', '-')}"


def negated_flag_of(name: str) -> str:
    """Write the flag that switches a setting off: `--no-images`."""
    return f"--no-{name.replace('_', '-')}"


def service_of(name: str) -> str:
    """Name the first service that has a setting."""
    return next(service for service, settings in DECLARED.items() if name in settings.model_fields)
