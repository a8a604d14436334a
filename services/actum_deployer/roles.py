"""The one table of roles: who may put, read, be asked and ask what. Whatever it does not allow is denied.

Access control, credentials, compose files and the page on security are made from it.
"""

import hashlib
from dataclasses import dataclass

from actum import keys
from actum.keys import BASE, Topic

IMAGES = (keys.COLOR, keys.DEPTH)
"""The topics that show people as a camera sees them."""
WITHOUT_IMAGES = tuple(topic for topic in keys.TOPICS if topic not in (*IMAGES, keys.INFO))
"""What may be read by whoever may watch; `info` is asked for, not read."""


@dataclass(frozen=True)
class Role:
    """One row of the table.

    Attributes:
        name: the role's name; with its sensors' it is the identity that a certificate shows, `gateway.kinect0`.
        about: who has it, for people.
        services: the services that run with it: it puts their status and answers for them. None for a person's
            program, which may work with every sensor.
        serves_several: whether one process of it serves all sensors of its host, instead of one for each.
        puts: the topics that it puts.
        reads: the topics that it receives.
        inspects: whether it may ask which services there are, and for their descriptions.
        commands: whether it may ask services to do something.
        ros_puts: what it puts on ROS 2's keys, below a domain; `{}` stands for the sensor.
        ros_reads: what it receives of them.
    """

    name: str
    about: str
    services: tuple[str, ...] = ()
    serves_several: bool = False
    puts: tuple[Topic, ...] = ()
    reads: tuple[Topic, ...] = ()
    inspects: bool = False
    commands: bool = False
    ros_puts: tuple[str, ...] = ()
    ros_reads: tuple[str, ...] = ()

    @property
    def speaks_ros(self) -> bool:
        """Whether it takes part only where there is a bridge to ROS 2."""
        return bool(self.ros_puts)


ROS_WITHOUT_PEOPLE = (
    *(f"{BASE}/{{}}/{name}" for name in ("skeletons", "objects", "event", "event_json", "intent")),
    *("tf", "tf_static", "intents"),
)
"""What the bridge publishes on ROS 2's keys, below a domain, in the namespace that it has unless it is told another,
where others publish the bodies."""
ROS_TOPICS = (*ROS_WITHOUT_PEOPLE, "humans")
"""What it publishes where it publishes bodies and persons, too.

`humans` stands for all topics of ROS4HRI below it, which come and go with the people.
"""
ROS_MARKS = (f"{BASE}/{{}}/mark",)
"""What it subscribes to."""
ROS_BODIES = (
    *("humans/bodies/tracked", "humans/bodies/*/joint_states", "humans/bodies/*/skeleton2d"),
    *("humans/bodies/*/urdf", "tf", "tf_static"),
)
"""What it also subscribes to where the bodies that ROS 2 nodes track become skeletons; it publishes there, too.

Pictures of bodies, which detectors publish as well, are not among them: images stay on their host.
"""
GATEWAY = Role(
    "gateway",
    "a sensor's gateway, or the simulated scene",
    services=("sensor_gateway", "marker_camera"),
    puts=(keys.SKELETON, keys.COLOR, keys.DEPTH, keys.TRUTH),
)
PREPROCESSOR = Role(
    "preprocessor",
    "the preprocessor",
    services=("pose_preprocessor",),
    serves_several=True,
    puts=(keys.POSTURE,),
    reads=(keys.SKELETON,),
)
CLASSIFIER = Role(
    "classifier",
    "the classifier, which also publishes the segments that it finds",
    services=("som_classifier",),
    serves_several=True,
    puts=(keys.SEGMENT, keys.ACTION, keys.HELD_BACK, keys.CONTINUATION),
    reads=(keys.POSTURE, keys.SEGMENT, keys.ACTION),
)
TRACKER = Role(
    "tracker",
    "the marker tracker",
    services=("marker_tracker",),
    serves_several=True,
    puts=(keys.OBJECTS,),
    reads=(keys.COLOR,),
)
FUSION = Role(
    "fusion",
    "the fusion",
    services=("action_fusion",),
    serves_several=True,
    puts=(keys.EVENT, keys.INTENT),
    reads=(keys.POSTURE, keys.OBJECTS, keys.ACTION, keys.EVENT),
)
TRAINER = Role(
    "trainer",
    "the trainer",
    services=("model_trainer",),
    serves_several=True,
    puts=(keys.TRAINING,),
    reads=(keys.SKELETON, keys.SEGMENT),
)
PAGE = Role(
    "page",
    "the web page, which publishes marks for its users",
    services=("web_dashboard",),
    puts=(keys.SEGMENT,),
    reads=(*WITHOUT_IMAGES, keys.COLOR),
    inspects=True,
    commands=True,
)
WITHOUT_CAMERA = (keys.SKELETON, keys.OBJECTS, keys.EVENT, keys.INTENT)
"""What the bridge reads unless it says where bodies are in the image."""
BRIDGE = Role(
    "ros2",
    "the bridge to ROS 2, which publishes marks for ROS 2 nodes",
    services=("ros2_bridge",),
    puts=(keys.SEGMENT,),
    reads=(*WITHOUT_CAMERA, keys.COLOR),
    ros_puts=ROS_TOPICS,
    ros_reads=ROS_MARKS,
)
BODIES_BRIDGE = Role(
    "ros2_bodies",
    "the bridge to ROS 2 that also publishes as skeletons the bodies that ROS 2 nodes track",
    services=BRIDGE.services,
    puts=(*BRIDGE.puts, keys.SKELETON),
    reads=WITHOUT_CAMERA,
    ros_puts=ROS_WITHOUT_PEOPLE,
    ros_reads=(*BRIDGE.ros_reads, *ROS_BODIES),
)
ROBOT = Role(
    "robot",
    "ROS 2 nodes or their router, which read the bridge's topics and publish marks",
    ros_puts=ROS_MARKS,
    ros_reads=ROS_TOPICS,
)
DETECTOR = Role(
    "detector",
    "ROS 2 nodes or their router, which also publish bodies and transforms for the bridge",
    ros_puts=(*ROBOT.ros_puts, *ROS_BODIES),
    ros_reads=ROBOT.ros_reads,
)
SWITCH = Role(
    "switch",
    "a person or program that publishes marks and sends commands to services",
    puts=(keys.SEGMENT,),
    reads=WITHOUT_IMAGES,
    inspects=True,
    commands=True,
)
VIEWER = Role(
    "viewer",
    "a person or program that reads everything but images",
    reads=WITHOUT_IMAGES,
    inspects=True,
)
RECORDER = Role(
    "recorder",
    "a person or program that reads everything, including images, and records",
    reads=(*WITHOUT_IMAGES, *IMAGES),
    inspects=True,
)

ROLES = (
    *(GATEWAY, PREPROCESSOR, CLASSIFIER, TRACKER, FUSION, TRAINER, PAGE, BRIDGE, BODIES_BRIDGE),
    *(SWITCH, VIEWER, RECORDER, ROBOT, DETECTOR),
)
"""Every role but that of routers, which pass on what others may put."""
PEOPLES = tuple(role for role in ROLES if not role.services)
"""The roles of people's programs, such as `actum watch`."""
ROUTER = "router"
"""The name of a router's role; with its host's it is its identity, `router.camera`."""
LONGEST_COMMON_NAME = 64
"""Characters of a certificate's common name (RFC 5280)."""
LONGEST_FOLDER = 255
"""Characters of a folder's name on usual file systems: credentials lie in one that is called like their identity."""
DIGEST_LENGTH = 16
"""Characters of the digest that stands for the end of a name that is too long."""


def identity(role: Role, sensors: str) -> str:
    """Return the identity of who has a role: a service's names its sensors, such as `classifier.left+right`."""
    if not role.services:
        return role.name
    return shortened(f"{role.name}.{sensors.replace(',', '+')}", LONGEST_FOLDER)


def router_identity(host: str) -> str:
    """Return the identity of a host's router."""
    return f"{ROUTER}.{host}"


def common_name(identity: str, revoked: int = 0) -> str:
    """Return the name by which routers know an identity whose credentials were revoked so often.

    A certificate with an earlier name is somebody's whom no rule allows anything.
    """
    return shortened(f"{identity}#{revoked}" if revoked else identity, LONGEST_COMMON_NAME)


def shortened(name: str, longest: int, before_digest: str = ".") -> str:
    """Return a name, or where it is longer than `longest` its beginning and a digest of it, which no other name has."""
    if len(name) <= longest:
        return name
    digest = hashlib.sha256(name.encode()).hexdigest()[:DIGEST_LENGTH]
    return f"{name[: longest - DIGEST_LENGTH - 1]}{before_digest}{digest}"
