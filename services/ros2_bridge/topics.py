"""The bridge's table of ROS 2 topics, and how rmw_zenoh writes them: keys, liveliness tokens, attachments."""

import hashlib
import struct
from dataclasses import dataclass
from functools import partial
from typing import Literal

from actum.bridge import ForeignNode, ForeignTopic
from ros2_bridge import message_types as types
from ros2_bridge.hri import types as hri
from ros2_bridge.settings import OTHERS, Settings, TopicName

NODE = "bridge"
"""The name of the bridge's node, in the namespace of its topics."""
NO_HASH = "TypeHashNotSupported"
"""What stands in keys in the place of a type's hash where ROS 2 knows none, as Humble."""


@dataclass(frozen=True)
class RosTopic:
    """One row of the table: a topic's name below the namespace, or from the root, its type, and its quality of service.

    All are reliable and keep the last `depth`. `chosen_by` is the setting's word for it; latched is transient local. In
    the name of a topic that each body has, `*` stands for the body's id.
    """

    name: str
    type: str
    chosen_by: TopicName | Literal["others"]
    depth: int = 10
    latched: bool = False


SKELETONS = RosTopic("skeletons", types.MARKER_ARRAY, "skeletons")
TF = RosTopic("/tf", types.TF_MESSAGE, "tf", depth=100)
TF_STATIC = RosTopic("/tf_static", types.TF_MESSAGE, "tf", depth=1, latched=True)
OBJECTS = RosTopic("objects", types.DETECTION_3D_ARRAY, "objects")
EVENT = RosTopic("event", types.ACTION_EVENT, "event", depth=1, latched=True)
EVENT_JSON = RosTopic("event_json", types.STRING, "event_json", depth=1, latched=True)
INTENT = RosTopic("intent", types.ACTION_INTENT, "intent")
MARK = RosTopic("mark", types.STRING, "mark")
OTHERS_TRACKED = RosTopic("/humans/bodies/tracked", hri.IDS_LIST, OTHERS)
OTHERS_TF = RosTopic("/tf", types.TF_MESSAGE, OTHERS, depth=100)
OTHERS_TF_STATIC = RosTopic("/tf_static", types.TF_MESSAGE, OTHERS, latched=True)
OTHERS_JOINT_STATES = RosTopic("/humans/bodies/*/joint_states", hri.JOINT_STATE, OTHERS)
OTHERS_SKELETON_2D = RosTopic("/humans/bodies/*/skeleton2d", hri.SKELETON_2D, OTHERS)
OTHERS_URDF = RosTopic("/humans/bodies/*/urdf", types.STRING, OTHERS, depth=1, latched=True)
BODIES_TRACKED = RosTopic("/humans/bodies/tracked", hri.IDS_LIST, "bodies")
PERSONS_TRACKED = RosTopic("/humans/persons/tracked", hri.IDS_LIST, "persons")
CANDIDATE_MATCHES = RosTopic("/humans/candidate_matches", hri.IDS_MATCH, "persons")
INTENTS = RosTopic("/intents", hri.INTENT, "intents")

PUBLISHED = (
    *(SKELETONS, TF, TF_STATIC, OBJECTS, EVENT, EVENT_JSON, INTENT),
    *(BODIES_TRACKED, PERSONS_TRACKED, CANDIDATE_MATCHES, INTENTS),
)
"""Published as long as the bridge runs. Those of one body or person, in `ros2_bridge.hri_out.present`, come and go."""
SUBSCRIBED = (
    *(MARK, OTHERS_TRACKED, OTHERS_TF, OTHERS_TF_STATIC, OTHERS_JOINT_STATES, OTHERS_SKELETON_2D),
    OTHERS_URDF,
)


def node(settings: Settings, session_id: str) -> ForeignNode:
    """Return what the bridge declares in a Zenoh session: a node with the chosen topics."""
    numbered = enumerate((*PUBLISHED, *SUBSCRIBED), 1)
    chosen = [(number, topic) for number, topic in numbered if topic.chosen_by in settings.chosen_topics]
    return ForeignNode(
        _entity(settings, session_id, 0, "NN"),
        tuple(published(topic, settings, session_id, number) for number, topic in chosen if topic in PUBLISHED),
        tuple(
            _declared(topic, settings, _entity(settings, session_id, number, "MS"))
            for number, topic in chosen
            if topic in SUBSCRIBED
        ),
    )


def published(topic: RosTopic, settings: Settings, session_id: str, number: int) -> ForeignTopic:
    """Return a topic as the bridge publishes it; `number` is no other's of the session."""
    return _declared(topic, settings, _entity(settings, session_id, number, "MP"))


def _entity(settings: Settings, session_id: str, number: int, kind: str) -> str:
    """Return the beginning of the token of the node (NN), a publisher (MP) or a subscriber (MS)."""
    return f"@ros2_lv/{settings.ros_domain_id}/{session_id}/0/{number}/{kind}/%/{_mangled(settings.namespace)}/{NODE}"


def _declared(topic: RosTopic, settings: Settings, entity: str) -> ForeignTopic:
    """Return the topic as it is declared; `entity` is the token's part before it."""
    path = f"{settings.namespace}/{topic.name}".strip("/") if topic.name[0] != "/" else topic.name[1:]
    package, kind, name = topic.type.split("/")
    type_hash = NO_HASH if settings.ros_distro == "humble" else types.type_hash(topic.type)
    typed = f"{package}::{kind}::dds_::{name}_/{type_hash}"
    token = f"{entity}/{_mangled(path)}/{typed}/:{'1' if topic.latched else ''}:,{topic.depth}:,:,:,,"
    gid = hashlib.blake2b(token.encode(), digest_size=16).digest()
    return ForeignTopic(
        name=topic.name,
        key=f"{settings.ros_domain_id}/{path}/{typed}",
        token="" if "*" in path else token,  # a token names one topic
        latched=topic.latched,
        attachment=partial(attachment, gid),
    )


def attachment(gid: bytes, number: int, put_ns: int) -> bytes:
    """Return what rmw_zenoh expects beside a message: its number, the time of the put, and who put it (16 bytes)."""
    return struct.pack("<qqB", number, put_ns, len(gid)) + gid


def _mangled(path: str) -> str:
    """Write a name without the slash before it as one chunk of a key: `%` stands for `/`."""
    return f"%{path}".replace("/", "%")
