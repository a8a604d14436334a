"""The processes of a whole system, as programs to supervise."""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from actum.settings import PROCESS_ENVIRONMENT, ServiceSettings
from actum_command.dealing import counted_on, dealt
from actum_command.model_in_use import ModelInUse
from actum_command.service_settings import TRAINER, Given, arguments_of
from actum_command.supervising import Program
from marker_tracker.settings import Settings as TrackerSettings
from scene_simulator.parameters import load_parameters

SERVICES = ("pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion")
"""The services behind the sensor, in the order of the stream: `actum up` and `actum demo` start them."""

GATEWAY, SCENE = "sensor_gateway", "scene_simulator"
"""The services that are the source of a sensor: cameras and recordings, and the simulated scene."""

PAGE = "web_dashboard"
"""The service that shows all of one sensor to browsers."""


def system(settings: ServiceSettings, source: str, model: ModelInUse, given: Given) -> list[Program]:
    """Return all programs of a system but its router: the four services, the trainer, and the source of each sensor.

    The services and the trainer are one process each, however many sensors the settings name.
    """
    own_scene = "scene" in given or TrackerSettings().scene is not None
    objects = {} if own_scene or source != "simulator" else simulated_objects()
    serving = [*services(settings, model.file, objects, given), trainer(settings, model, given)]
    return [*serving, *sources(settings, source, given)]


def sources(settings: ServiceSettings, source: str, given: Given) -> list[Program]:
    """Return the program that is the source of each sensor; none where other programs are.

    Simulated scenes of several sensors differ in their seeds.
    """
    if source == "none":
        return []
    if source == "simulator":
        scenes = counted_on(given, SCENE, "seed", settings)
        return of_each_sensor(settings, SCENE, scenes, simulator)
    return of_each_sensor(settings, GATEWAY, given, lambda own, its: gateway(own, ["--source", source, *its]))


def of_each_sensor(
    settings: ServiceSettings,
    service: str,
    given: Given,
    program_of: Callable[[ServiceSettings, Sequence[str]], Program],
) -> list[Program]:
    """Return a program for each sensor, made from its settings and the flags of a service.

    Where there are several sensors, the name of each program ends in that of its sensor.
    """
    flags = [arguments_of(service, its) for its in dealt(given, service, settings)]
    programs = [program_of(own, its) for own, its in zip(settings.of_each_sensor, flags, strict=True)]
    if len(programs) == 1:
        return programs
    return [replace(program, name=f"{program.name}-{program.environment['ACTUM_SENSOR']}") for program in programs]


def with_page(
    settings: ServiceSettings, programs: Sequence[Program], given: Given = MappingProxyType({})
) -> list[Program]:
    """Return programs with the page of each sensor beside them, and have the classifier put the maps that it shows.

    Where the page's dependencies are not installed they are returned as they are.
    """
    if find_spec("uvicorn") is None:
        return list(programs)
    maps = {"ACTUM_PUBLISH_MAPS": os.environ.get("ACTUM_PUBLISH_MAPS", "1")}
    showing = [
        replace(program, environment={**program.environment, **maps}) if program.name == "som_classifier" else program
        for program in programs
    ]
    return [*showing, *of_each_sensor(settings, PAGE, given, page)]


def common(settings: ServiceSettings) -> dict[str, str]:
    """Return the environment that every process of one system shares."""
    return {"ACTUM_CONNECT": settings.connect, "ACTUM_SENSOR": settings.sensor, **PROCESS_ENVIRONMENT}


def router(settings: ServiceSettings) -> Program:
    """Return the program of the embedded router, which listens where the others connect."""
    own = settings.of_each_sensor[0]  # it serves any sensor, but its settings name one
    return Program("router", "actum_command", ["router", "--listen", settings.connect], common(own))


def simulated_objects() -> dict[str, str]:
    """Return the environment that tells the tracker which object carries which marker in the simulated scene."""
    objects = load_parameters().objects
    specs = {item.id: {"name": item.name, "size_m": objects.marker_size_m} for item in objects.items}
    return {"ACTUM_OBJECTS": json.dumps(specs)}


def services(
    settings: ServiceSettings, model: Path | None, objects: Mapping[str, str], given: Given = MappingProxyType({})
) -> list[Program]:
    """Return the programs of the four services behind the sensor, with those of the given settings that they have.

    `objects` is the environment that lists the objects for the tracker, as `simulated_objects` returns it.
    """
    environment = {**common(settings), **objects}
    if model is not None:
        environment["ACTUM_MODEL"] = str(model)
    return [Program(name, name, arguments_of(name, given), environment) for name in SERVICES]


def trainer(settings: ServiceSettings, model: ModelInUse, given: Given) -> Program:
    """Return the program of the trainer, which puts models into use and follows the original."""
    environment = {**common(settings), "ACTUM_MODEL": str(model.file)}
    if model.original is not None:
        environment["ACTUM_ORIGINAL_MODEL"] = str(model.original)
    return Program(TRAINER, "model_trainer", arguments_of(TRAINER, given), environment)


def gateway(settings: ServiceSettings, arguments: Sequence[str]) -> Program:
    """Return the program of the sensor gateway with its arguments."""
    return Program(GATEWAY, GATEWAY, arguments, common(settings))


def simulator(settings: ServiceSettings, arguments: Sequence[str]) -> Program:
    """Return the program of the simulated scene, which replaces the sensor gateway."""
    return Program(SCENE, SCENE, arguments, common(settings))


def page(settings: ServiceSettings, arguments: Sequence[str]) -> Program:
    """Return the program of the page of one sensor."""
    return Program(PAGE, PAGE, arguments, common(settings))


def scenes(settings: ServiceSettings) -> list[Program]:
    """Return the programs of the clients that put the marks of each sensor's simulated scene."""
    return of_each_sensor(settings, SCENE, {}, lambda own, _: scene(own))


def scene(settings: ServiceSettings) -> Program:
    """Return the program of the client that puts the marks of one sensor's simulated scene."""
    return Program("scene", "actum_command", ["scene"], common(settings))
