"""The processes of a whole system, as programs to supervise."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from actum.settings import PROCESS_ENVIRONMENT, ServiceSettings
from actum_command.service_settings import TRAINER, Given, arguments_of
from actum_command.supervising import Program
from actum_model_trainer.settings import Settings
from marker_tracker.settings import Settings as TrackerSettings
from scene_simulator.parameters import load_parameters

SERVICES = ("pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion")
"""The services behind the sensor, in the order of the stream."""

PAGE = "web_dashboard"
"""The service that shows all of it to browsers."""


def system(
    settings: ServiceSettings, source: str, path: Path | None, model: Path | None, given: Given
) -> list[Program]:
    """Return all programs of a system but its router: the four services, the trainer, and the sensor that is named.

    Where no model is named, the classifier uses the one that was taught last, as soon as there is one.

    The simulated scene's actions are marked, unless only those are wanted that the classifier finds by itself.
    """
    watched = model or taught_model(given)
    if source == "simulator":
        marking = [] if given.get("segments") == ["auto"] else [scene(settings)]
        sensor = simulator(settings, arguments_of("scene_simulator", given))
        own_scene = "scene" in given or TrackerSettings().scene is not None
        return [
            *services(settings, watched, {} if own_scene else simulated_objects(), given),
            trainer(settings, watched, given),
            sensor,
            *marking,
        ]
    programs = [*services(settings, watched, {}, given), trainer(settings, watched, given)]
    if source != "none":
        play = ["--path", str(path)] if path else []
        programs.append(gateway(settings, ["--source", source, *play, *arguments_of("sensor_gateway", given)]))
    return programs


def with_page(
    settings: ServiceSettings, programs: Sequence[Program], given: Given = MappingProxyType({})
) -> list[Program]:
    """Return programs with the page beside them, and have the classifier put the maps that it shows.

    Where the page's dependencies are not installed they are returned as they are.
    """
    if find_spec("uvicorn") is None:
        return list(programs)
    maps = {"ACTUM_PUBLISH_MAPS": os.environ.get("ACTUM_PUBLISH_MAPS", "1")}
    showing = [
        replace(program, environment={**program.environment, **maps}) if program.name == "som_classifier" else program
        for program in programs
    ]
    return [*showing, Program(PAGE, PAGE, arguments_of(PAGE, given), common(settings))]


def common(settings: ServiceSettings) -> dict[str, str]:
    """Return the environment that every process of one system shares."""
    return {"ACTUM_CONNECT": settings.connect, "ACTUM_SENSOR": settings.sensor, **PROCESS_ENVIRONMENT}


def router(settings: ServiceSettings) -> Program:
    """Return the program of the embedded router, which listens where the others connect."""
    return Program("router", "actum_command", ["router", "--listen", settings.connect], common(settings))


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


def taught_model(given: Given) -> Path:
    """Return the file of the model that was taught last: in the trainer's folder, as that is set."""
    folder = given.get("trainer_data")
    named = folder[-1] if isinstance(folder, list) else Settings().trainer_data
    return Path(named) / "model.npz"


def trainer(settings: ServiceSettings, model: Path, given: Given) -> Program:
    """Return the program of the trainer, which puts models into use as this file."""
    environment = {**common(settings), "ACTUM_MODEL": str(model)}
    return Program(TRAINER, "actum_model_trainer", arguments_of(TRAINER, given), environment)


def gateway(settings: ServiceSettings, arguments: Sequence[str]) -> Program:
    """Return the program of the sensor gateway with its arguments."""
    return Program("sensor_gateway", "sensor_gateway", arguments, common(settings))


def simulator(settings: ServiceSettings, arguments: Sequence[str]) -> Program:
    """Return the program of the simulated scene, which replaces the sensor gateway."""
    return Program("scene_simulator", "scene_simulator", arguments, common(settings))


def scene(settings: ServiceSettings) -> Program:
    """Return the program of the client that puts the simulated scene's marks."""
    return Program("scene", "actum_command", ["scene"], common(settings))
