"""Before a whole system starts: checks of its source and endpoint, and what is printed of its model."""

import errno
import socket
import threading
import time
from contextlib import ExitStack
from importlib.util import find_spec

from actum.runtime import Client, RouterUnreachableError
from actum.settings import ServiceSettings, SettingsError, host_and_port
from actum_command.dealing import counted_on
from actum_command.model_in_use import NO_MODEL, ModelInUse, lack_of_file
from actum_command.processes import GATEWAY, PAGE, SCENE
from actum_command.service_settings import DECLARED, Given, flag_of, service_of
from actum_command.simulated_model import SIMULATED_MODEL
from som_classifier.model_loading import ModelError, load_model
from som_classifier.settings import Settings as ClassifierSettings
from som_classifier.spotting.spotted import SpottingOptions

CHECK_S = 0.2  # interval of checks for the router: so short that nobody notices the wait
ROUTER_S = 5.0  # a router is up within a second; services wait for it by themselves where it takes longer

FILES_ELSEWHERE = {
    "simulator": "To play recordings, use --source recording",
    "none": "To play recordings, use --source recording",
    "camera": "To read a video file, set ACTUM_CAMERA to that file",
}
"""The sources that play no file, each with how a file is named instead."""

CAMERAS_ELSEWHERE = (
    ". For cameras use --source none, and start a gateway for each sensor on a host of its own, because each "
    "gateway opens the first camera that it finds"
)
"""What to do with several cameras that no setting tells apart instead of their recordings."""

WITHOUT_CAMERA = ("simulator", "recording")
"""The sources that have no camera to choose."""

SENSORS = {"none": None, "simulator": SCENE}
"""The service that puts the sensor's streams, by source, where it is not the sensor gateway."""

LOCAL = "127.0.0.1"
"""Address at which free ports are looked for: pages listen on it by default."""

LISTEN_REMEDIES = {
    errno.EADDRINUSE: "stop the program that uses this port, or set ACTUM_CONNECT to an endpoint with another port",
    errno.EACCES: "set ACTUM_CONNECT to an endpoint with a port of 1024 or more",
}
"""What to do if a router cannot listen, by the system's error."""
OWN_ADDRESS = "set ACTUM_CONNECT to an address of this machine, or to tcp/0.0.0.0:7447, which is all its addresses"
"""What to do if a router cannot listen because another machine, or none, has the address."""

SCENE_MARKS = "the simulated scene marks its own actions, as a switch would"
"""How actions are found where the simulated scene marks them."""
FOUND = {
    "marks": "only marked actions are recognised, and nobody marks here: mark with 'actum segment toggle', or have "
    "'actum play' play marks beside --source none",
    "auto": "actions are found by the model; marks are refused, and --segments both takes them as well",
    "both": "actions are found by the model, or marked by you: 'actum segment toggle'",
}
"""How actions are found, by the setting `segments`."""


def chosen_source(named: str | None, given: Given) -> str:
    """Return the named source; where none is named, the camera if one is given, else the simulator.

    Raises:
        SettingsError: it does not start the service that a given setting is for, or plays no file though one is named.
    """
    source = named or ("camera" if "camera" in given else "simulator")
    if "path" in given and (remedy := FILES_ELSEWHERE.get(source)):
        raise SettingsError(f"--source {source} does not read --path: leave out --path. {remedy}")
    if "camera" in given and source in WITHOUT_CAMERA:
        raise SettingsError(f"--source {source} uses no camera: leave out --camera, or use --source camera")
    absent = {GATEWAY, SCENE} - {SENSORS.get(source, GATEWAY)}
    of_started = {name for service in DECLARED.keys() - absent for name in DECLARED[service].model_fields}
    for name in (name for name in given if name not in of_started):
        flag, service = flag_of(name), service_of(name)
        raise SettingsError(
            f"{flag} is a setting of {service}, which --source {source} does not start: leave out {flag}, or use "
            "another --source"
        )
    return source


def refuse_shared_source(source: str, given: Given, settings: ServiceSettings) -> None:
    """Check that each of several sensors has a camera or recording of its own.

    Raises:
        SettingsError: there are more of them than sensors, or fewer.
    """
    count, setting = len(settings.of_each_sensor), "camera" if source == "camera" else "path"
    named = given.get(setting, [])
    if count == 1 or source in SENSORS or not isinstance(named, list) or len(named) == count:
        return
    flag, hosts = flag_of(setting), "" if source in ("camera", "recording") else CAMERAS_ELSEWHERE
    raise SettingsError(
        f"--source {source} for {count} sensors needs {flag} {count} times, but {flag} is given {len(named)} times: "
        f"give {flag} once for each sensor, in the order of the sensors{hosts}"
    )


def with_page_ports(given: Given, settings: ServiceSettings) -> Given:
    """Return the given settings with a port for the page of each of several sensors, in their order.

    The first port is the one that is set, and the others follow it. If none is set, the first free ports are taken.

    Raises:
        SettingsError: there are too few free ports.
        ValidationError: a setting of the page cannot be used.
    """
    count, ports = len(settings.of_each_sensor), counted_on(given, PAGE, "page_port", settings)
    if count == 1 or "page_port" in ports or find_spec("uvicorn") is None:
        return ports
    from web_dashboard.server import bound_socket  # imports uvicorn, which the command line alone does without

    with ExitStack() as held:  # all at once, so that no port is found twice
        found = [held.enter_context(bound_socket(LOCAL, None)) for _ in range(count)]
        return {**given, "page_port": [str(each.getsockname()[1]) for each in found]}


def refuse_marks(marked: bool, source: str, segments: str) -> None:
    """Check that the simulated scene's own marks are of use.

    Raises:
        SettingsError: the source is no simulated scene, or marks are not answered.
    """
    if marked and source != "simulator":
        raise SettingsError(
            f"--marked works only with --source simulator, not with --source {source}: leave out --marked"
        )
    if marked and segments == "auto":
        raise SettingsError(
            "--segments auto ignores the marks that --marked publishes: leave out --marked, or use --segments both"
        )


def refuse_taken(endpoint: str) -> None:
    """Check that the router can listen at an endpoint.

    Raises:
        SettingsError: it is no endpoint, or something listens there already.
    """
    address = host_and_port(endpoint)
    if address is None or not endpoint.startswith("tcp/"):
        return
    host, port = address
    try:
        family, kind, protocol, _, place = socket.getaddrinfo(
            host or "0.0.0.0", port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        with socket.socket(family, kind, protocol) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(place)
    except OSError as error:
        remedy = LISTEN_REMEDIES.get(error.errno or 0, OWN_ADDRESS)
        raise SettingsError(f"the router cannot listen at {endpoint} ({error.strerror}): {remedy}") from None


def wait_for_router(here: ServiceSettings, stop: threading.Event) -> None:
    """Give the router time to come up, so that the services find it at once; if it does not, they wait for it.

    Raises:
        SettingsError: no session can be opened with these settings.
    """
    deadline_s = time.monotonic() + ROUTER_S
    while time.monotonic() < deadline_s and not stop.wait(CHECK_S):
        try:
            with Client(here, wait_s=0):
                return
        except RouterUnreachableError:
            continue


def segments_of(given: Given) -> str:
    """Return which segments are answered, as the classifier's setting says."""
    named = given.get("segments")
    return named[-1] if isinstance(named, list) else ClassifierSettings().segments


def how_found(segments: str, marked: bool) -> str:
    """Return in words how actions are found; a setting that there is not is refused by the classifier."""
    return SCENE_MARKS if marked else FOUND.get(segments, f"segments {segments}")


def source_of(model: ModelInUse) -> str:
    """Return in words where the model in use is from."""
    if model.original is None:
        return "the one that was put into use last"
    if model.original == SIMULATED_MODEL:
        return "the one for the simulated scene that ships with actum"
    return f"{model.original}, which is only read: what is put into use on the page replaces a copy"


def lack_of_model(model: ModelInUse, segments: str, marked: bool) -> str | None:
    """Return what the model cannot do with which the system starts; None where it does what is needed."""
    file = model.original or model.file
    if not file.exists():
        return lack_of_file(model) or NO_MODEL
    try:
        loaded = load_model(file)
    except ModelError as error:
        return str(error)
    if marked or segments == "marks" or loaded.spotter(SpottingOptions()) is not None:
        return None
    return (
        f"{file} finds no actions by itself, since it was trained without continuous recordings: mark each one, with "
        "'actum segment toggle' or, in the simulated scene, --marked"
    )
