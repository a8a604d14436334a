"""Turns messages into what Rerun logs: an entity's path, which begins with the sensor, and what is shown there."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from actum import keys
from actum.messages import Action, Agent, Image, Message, Objects, Skeleton, TrackedObject
from actum_command.viewers.contents import AXIS_M, BONE_M, JOINT_M, Presence, Rgb, figure, log_line, misfit

TIMELINE = "capture"
"""The timeline on which everything stands: a message's `stamp_ns`, from 1970 on."""
MILLIMETRES = 1000.0
"""Units of a depth image in a metre."""
IMAGE_PLANE_M = 0.5
"""How far (m) before its camera an image hangs: between the camera and the people."""
EYE = rrb.EyeControls3D(position=[1.6, -0.8, 0.3], look_target=[0.0, 0.1, 2.2], eye_up=[0.0, -1.0, 0.0])
"""From where the space is seen at first (m, camera frame): beside the camera and above it, on people 2 m before it."""
COLUMNS = rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])
"""What the log shows beside the time."""
SEEN: Rgb = (90, 200, 110)
"""The colour of an object that is seen: green."""
NOT_SEEN: Rgb = (170, 170, 170)
"""The colour of one that is followed or remembered: grey."""


@dataclass(frozen=True)
class Entry:
    """What is logged on one entity's path, at a message's stamp, or for all times where it is static."""

    path: str
    shown: Sequence[Any]
    static: bool = False


class RerunEntries:
    """Turns messages into entries; who or what a sensor names no more is taken away."""

    def __init__(self) -> None:
        self._sensors: set[str] = set()
        self._people, self._objects = Presence(), Presence()

    def of(self, message: Message) -> list[Entry]:
        """Return what is shown of one message; nothing of postures, which are skeletons turned, and of status."""
        entries = [*self._content(message), *_line(message)]
        if message.sensor not in self._sensors:  # how the camera frame lies: x right, y down, z forward
            self._sensors.add(message.sensor)
            entries.insert(0, Entry(message.sensor, [rr.ViewCoordinates.RDF], static=True))
        return entries

    def _content(self, message: Message) -> Iterator[Entry]:
        match message:
            case Skeleton(valid=True):
                agents = {agent.agent: agent for agent in message.agents}
                for gone in self._people.departed(message.sensor, agents):
                    yield _cleared(f"{message.sensor}/people/{gone}")
                for number, agent in agents.items():
                    yield from _person(f"{message.sensor}/people/{number}", agent)
            case Objects(valid=True):
                objects = {tracked.id: tracked for tracked in message.objects}
                for gone in self._objects.departed(message.sensor, objects):
                    yield _cleared(f"{message.sensor}/objects/{gone}")
                for number, tracked in objects.items():
                    yield _object(f"{message.sensor}/objects/{number}", tracked)
            case Image(valid=True) if misfit(message) is None:
                yield _image(message)
            case Action(valid=True):
                yield from _courses(f"{message.sensor}/courses/{message.agent}", message)


def layout(sensors: Sequence[str]) -> rrb.Blueprint:
    """Return how the viewer is divided: for each sensor space, colour image, courses and log, on `capture`."""
    tabs = [
        rrb.Vertical(
            rrb.Horizontal(
                rrb.Spatial3DView(origin=sensor, name="space", eye_controls=EYE),
                rrb.Spatial2DView(origin=f"{sensor}/{keys.COLOR.leaf}", contents=f"/{sensor}/**", name="colour"),
            ),
            rrb.Horizontal(
                rrb.TimeSeriesView(origin=f"{sensor}/courses", name="courses"),
                rrb.TextLogView(origin=f"{sensor}/log", name="log", columns=COLUMNS),
            ),
            row_shares=[3, 2],
            name=sensor,
        )
        for sensor in sensors
    ]
    panels = rrb.BlueprintPanel(state="collapsed"), rrb.SelectionPanel(state="collapsed")
    time = rrb.TimePanel(timeline=TIMELINE, state="collapsed")
    return rrb.Blueprint(rrb.Tabs(*tabs), *panels, time, auto_views=False)


def _cleared(path: str) -> Entry:
    return Entry(path, [rr.Clear(recursive=True)])


def _person(path: str, agent: Agent) -> list[Entry]:
    drawn = figure(agent)
    joints = rr.Points3D(drawn.joints, colors=drawn.joint_colours, radii=JOINT_M, labels=drawn.names, show_labels=False)
    bones = rr.LineStrips3D(drawn.bones, colors=drawn.bone_colours, radii=BONE_M, labels=f"agent {agent.agent}")
    return [Entry(f"{path}/joints", [joints]), Entry(f"{path}/bones", [bones])]


def _object(path: str, tracked: TrackedObject) -> Entry:
    camera_from_object = rr.Transform3D(
        translation=tracked.position_m, quaternion=rr.Quaternion(xyzw=tracked.quaternion_xyzw)
    )
    middle = rr.Points3D(
        [[0.0, 0.0, 0.0]], colors=SEEN if tracked.seen else NOT_SEEN, radii=JOINT_M, labels=tracked.name
    )
    return Entry(path, [camera_from_object, rr.TransformAxes3D(AXIS_M), middle])


def _image(image: Image) -> Entry:
    """Show an image in its camera; the lens's distortion has no place in Rerun's cameras."""
    skeleton_from_image = np.reshape(image.skeleton_from_image, (4, 4))
    camera = rr.Pinhole(
        image_from_camera=np.reshape(image.K, (3, 3)),
        resolution=[image.width, image.height],
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=IMAGE_PLANE_M,
    )
    place = rr.Transform3D(translation=skeleton_from_image[:3, 3], mat3x3=skeleton_from_image[:3, :3])
    return Entry(f"{image.sensor}/{keys.address_of(image).topic.leaf}", [place, camera, _picture(image)])


def _picture(image: Image) -> Any:
    size = {"width": image.width, "height": image.height}
    match image.format:
        case "jpeg":
            return rr.EncodedImage(contents=image.data, media_type="image/jpeg")
        case "bgr8":
            return rr.Image(bytes=image.data, color_model="BGR", datatype="U8", **size)
        case "depth16_mm":
            depth_mm = np.frombuffer(image.data, "<u2").reshape(image.height, image.width)
            return rr.DepthImage(depth_mm, meter=MILLIMETRES)


def _courses(path: str, action: Action) -> Iterator[Entry]:
    """Show how a partial action's numbers go on; a final one ends their lines."""
    if action.final:
        yield _cleared(path)
        return
    numbers = {
        "probability": action.confidence,
        "completeness": action.completeness,
        "familiarity": action.familiarity,
    }
    for name, number in numbers.items():
        if number is not None:
            yield Entry(f"{path}/{name}", [rr.Scalars(number)])


def _line(message: Message) -> Iterator[Entry]:
    line = log_line(message)
    if line is not None:
        text, warns = line
        level = rr.TextLogLevel.WARN if warns else rr.TextLogLevel.INFO
        kind = message.SCHEMA.rpartition(".")[2]
        yield Entry(f"{message.sensor}/log/{kind}", [rr.TextLog(text, level=level)])
