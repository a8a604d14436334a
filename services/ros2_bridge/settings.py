"""Settings of the bridge to ROS 2."""

import re
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_settings import NoDecode

from actum.settings import ServiceSettings

TopicName = Literal[
    "skeletons", "tf", "objects", "event", "event_json", "intent", "mark",
    "bodies", "body_links", "cropped", "persons", "intents",
]  # fmt: skip
"""What can be published and, of `mark`, subscribed to. The last five are ROS4HRI's."""
UNLESS_CHOSEN: frozenset[TopicName] = frozenset(get_args(TopicName)) - {"cropped"}
"""What is exchanged unless topics are chosen: all but pictures of people."""
OF_BODIES: frozenset[TopicName] = frozenset(("bodies", "body_links", "cropped", "persons"))
"""The words for topics on which the bridge describes bodies."""
OTHERS: Literal["others"] = "others"
"""The word for the topics on which other nodes describe bodies, which `ros_bodies` chooses."""
ROS_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")
"""The characters of ROS 2's names, without the slash before them."""
HIGHEST_DOMAIN = 232
"""ROS 2's highest domain id."""


def _names(value: Any) -> Any:
    """Split `event,mark` at the commas; return what is no text unchanged."""
    return [name.strip() for name in value.split(",") if name.strip()] if isinstance(value, str) else value


class Settings(ServiceSettings):
    """Settings of the bridge, beside those of every service."""

    ros_domain_id: int = Field(0, ge=0, le=HIGHEST_DOMAIN, description="the ROS_DOMAIN_ID of your ROS 2 nodes")
    ros_namespace: str | None = Field(
        None,
        description=(
            "ROS namespace of all topics except /tf, /tf_static and the topics of ROS4HRI. Default: actum/SENSOR, such "
            "as actum/kinect0"
        ),
    )
    ros_distro: Literal["humble", "jazzy", "kilted"] = Field(
        "jazzy",
        description=(
            "the ROS 2 distribution of your nodes. A wrong distribution can prevent all communication, because the "
            "names of topics in Zenoh differ between humble and the other two distributions"
        ),
    )
    ros_topics: Annotated[frozenset[TopicName], NoDecode, BeforeValidator(_names)] = Field(
        UNLESS_CHOSEN,
        description=(
            "the topics to exchange with ROS 2, separated by commas, such as event,mark. The topic 'cropped' is not in "
            "the default, because its messages are images of people"
        ),
    )
    ros_hri_mapping: Path | None = Field(
        None,
        description=(
            "a YAML file that maps actions to the gestures and intents of ROS4HRI; default: no gestures and no intents "
            "are published"
        ),
    )
    ros_frame_id: str | None = Field(
        None,
        min_length=1,
        description=(
            "name of the camera's optical frame, if your robot's tf tree already contains this frame. With this "
            "option, the bridge publishes nothing on /tf_static. Default: the bridge publishes on /tf_static the frame "
            "SENSOR_link, such as kinect0_link, and its child frame SENSOR_optical_frame"
        ),
    )

    ros_bodies: bool = Field(
        False,
        description=(
            "take this sensor's skeletons not from a sensor gateway, but from ROS 2 nodes that track bodies (ROS4HRI: "
            "/humans/bodies, /tf); requires --ros-frame-id"
        ),
    )

    @field_validator("ros_namespace")
    @classmethod
    def _without_slashes(cls, namespace: str | None) -> str | None:
        return None if namespace is None else namespace.strip("/")

    @model_validator(mode="after")
    def _has_a_ros_name(self) -> "Settings":
        if self.namespace and not ROS_NAME.fullmatch(self.namespace):
            raise ValueError(
                f"{self.namespace!r} is not a ROS namespace: in --ros-namespace, separate names by '/', such as "
                "lab/kinect0. A name consists of letters, digits and '_', and does not begin with a digit"
            )
        return self

    @model_validator(mode="after")
    def _says_in_which_frame_bodies_are(self) -> "Settings":
        if self.ros_bodies and self.ros_frame_id is None:
            raise ValueError(
                "--ros-bodies needs --ros-frame-id: set --ros-frame-id to the optical frame of the camera that sees "
                "the bodies, as named in your robot's tf tree, such as camera_color_optical_frame"
            )
        return self

    @property
    def chosen_topics(self) -> frozenset[str]:
        """The words for the topics to exchange with ROS 2: whoever reads others' bodies does not publish them again."""
        return self.ros_topics - OF_BODIES | {OTHERS} if self.ros_bodies else self.ros_topics

    @property
    def namespace(self) -> str:
        """The topics' namespace without slashes around it; "" for none."""
        return f"actum/{self.sensor}" if self.ros_namespace is None else self.ros_namespace

    @property
    def frame_id(self) -> str:
        """The camera's optical frame."""
        return self.ros_frame_id or f"{self.sensor}_optical_frame"
