"""The processes of a whole system, as programs to supervise."""

from collections.abc import Sequence
from pathlib import Path

from actum.settings import ServiceSettings
from actum_command.supervising import Program

SERVICES = ("pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion")
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def common(settings: ServiceSettings) -> dict[str, str]:
    """The environment that every process of one system shares."""
    return {"ACTUM_CONNECT": settings.connect, "ACTUM_SENSOR": settings.sensor, **ONE_THREAD}


def router(settings: ServiceSettings) -> Program:
    """The embedded router, listening where the others connect."""
    return Program("router", "actum_command", ["router", "--listen", settings.connect], common(settings))


def services(settings: ServiceSettings, model: Path | None) -> list[Program]:
    """The four services behind the sensor."""
    environment = common(settings)
    if model is not None:
        environment["ACTUM_MODEL"] = str(model)
    return [Program(name, name, (), environment) for name in SERVICES]


def gateway(settings: ServiceSettings, arguments: Sequence[str]) -> Program:
    """The sensor gateway with its own arguments."""
    return Program("sensor_gateway", "sensor_gateway", arguments, common(settings))


def scene(settings: ServiceSettings) -> Program:
    """The client that puts the simulated scene's marks."""
    return Program("scene", "actum_command", ["scene"], common(settings))
