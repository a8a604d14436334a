"""What is declared is what rmw_zenoh declares: keys, tokens and attachments, letter by letter."""

import re
import struct
from pathlib import Path

import pytest
from pydantic import ValidationError

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.settings import complaint
from ros2_bridge import message_types
from ros2_bridge.message_types import OWN, type_hash
from ros2_bridge.settings import Settings
from ros2_bridge.topics import PUBLISHED, node

HASHES = {
    "std_msgs/msg/String": "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "tf2_msgs/msg/TFMessage": "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "visualization_msgs/msg/MarkerArray": "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
    "vision_msgs/msg/Detection3DArray": "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018",
    "hri_msgs/msg/IdsList": "RIHS01_7e0812d1ac945c98fd3e393568d581ad0ab567f37b24eff633eab778c1bfe62d",
    "hri_msgs/msg/Skeleton2D": "RIHS01_1cb61f012db6ca43c48fa0097ccab9a00108ea39323c13f01bb983323c1e3420",
    "hri_msgs/msg/Gesture": "RIHS01_06e95e9d3a204e075adfa05b9d737e48c51e1a2004ef762886ff82438bc9958d",
    "hri_msgs/msg/BodyPosture": "RIHS01_fa4258f18cc616a912e5aa1d48dbfead0fa5235a8546b4c69b70d64db7cef570",
    "hri_msgs/msg/IdsMatch": "RIHS01_1c649d4a87ca2d4fe5f606395e83a863640e411c9192dfda6d399a68019966f0",
    "hri_actions_msgs/msg/Intent": "RIHS01_850d5c0a06aecf153f4cbc75f27fc655d687f93300bcc928a9d21712716fcfaa",
    "hri_msgs/msg/NormalizedRegionOfInterest2D": "RIHS01_2e50c93f1ca166ee77af9a5424dc951ae4e452b740162a7f83c082d917dcaff5",  # noqa: E501
}
"""As other programs have them that speak with ROS 2; those of ROS4HRI computed from the files of the releases for
Jazzy, hri_msgs 2.3.2 and hri_actions_msgs 2.5.0."""
STRING = f"std_msgs::msg::dds_::String_/{HASHES['std_msgs/msg/String']}"


def test_types_have_the_hashes_by_which_ros_knows_them() -> None:
    assert {name: type_hash(name) for name in HASHES} == HASHES


OWN_HASHES = {
    "actum_msgs/msg/ActionEvent": "RIHS01_63877d6f475293326454adc2df2d594c2711b9328f26a3c0d220183235064293",
    "actum_msgs/msg/ActionIntent": "RIHS01_dd63e3c73b53845c4cea56b8f77c6a3e44fa2559f61cf18b0b3d1cd9d146989e",
    "actum_msgs/msg/IntendedContact": "RIHS01_3fa8aa0d7792ee51acd91e6117c457b9f2447c7972b660ae0aa0872c8c6ad3e2",
    "actum_msgs/msg/PersonAction": "RIHS01_5b617083ac53fc605a8b45c54b6dc15db9e083cf6a1d0833810adac1b678d2c9",
}


def test_the_hashes_of_our_own_types_stay_as_long_as_their_definitions() -> None:
    assert {name: type_hash(name) for name in OWN} == OWN_HASHES


def test_the_message_package_builds_each_of_our_own_types() -> None:
    built = (Path(message_types.__file__).parent / "actum_msgs/CMakeLists.txt").read_text(encoding="utf-8")
    assert {f"actum_msgs/{name}" for name in re.findall(r'"(msg/\w+)\.msg"', built)} == {*OWN}


def test_topics_stand_in_the_sensors_namespace_and_transforms_at_the_root() -> None:
    declared = node(Settings(), "5e55")
    assert [topic.key.split("::")[0].rpartition("/")[0] for topic in declared.publishes] == [
        "0/actum/kinect0/skeletons", "0/tf", "0/tf_static", "0/actum/kinect0/objects", "0/actum/kinect0/event",
        "0/actum/kinect0/event_json", "0/actum/kinect0/intent",
        "0/humans/bodies/tracked", "0/humans/persons/tracked", "0/humans/candidate_matches", "0/intents",
    ]  # fmt: skip
    assert [topic.key for topic in declared.subscribes] == [f"0/actum/kinect0/mark/{STRING}"]


def test_tokens_tell_of_the_node_its_topics_and_their_quality_of_service() -> None:
    declared = node(Settings(), "5e55")
    assert declared.token == "@ros2_lv/0/5e55/0/0/NN/%/%actum%kinect0/bridge"
    tokens = {topic.name: topic.token for topic in (*declared.publishes, *declared.subscribes)}
    entity = "%/%actum%kinect0/bridge"
    assert tokens["event_json"] == f"@ros2_lv/0/5e55/0/6/MP/{entity}/%actum%kinect0%event_json/{STRING}/:1:,1:,:,:,,"
    assert tokens["mark"] == f"@ros2_lv/0/5e55/0/12/MS/{entity}/%actum%kinect0%mark/{STRING}/::,10:,:,:,,"
    assert tokens["/tf"].endswith(f"/MP/{entity}/%tf/tf2_msgs::msg::dds_::TFMessage_/{HASHES[PUBLISHED[1].type]}/::,100:,:,:,,")  # fmt: skip # noqa: E501
    assert len({token.split("/")[4] for token in tokens.values()}) == len(tokens), "each has a number of its own"


def test_what_is_latched_says_so() -> None:
    assert {topic.name for topic in node(Settings(), "5e55").publishes if topic.latched} == {
        "/tf_static", "event", "event_json"
    }  # fmt: skip


def test_the_domain_the_namespace_and_the_topics_are_chosen() -> None:
    declared = node(Settings(ros_domain_id=42, ros_namespace="/robot1/", ros_topics="mark"), "5e55")
    assert declared.token == "@ros2_lv/42/5e55/0/0/NN/%/%robot1/bridge"
    assert declared.publishes == ()
    assert [topic.key for topic in declared.subscribes] == [f"42/robot1/mark/{STRING}"]


def test_without_a_namespace_topics_stand_at_the_root() -> None:
    declared = node(Settings(ros_namespace="", ros_topics="mark"), "5e55")
    assert declared.token == "@ros2_lv/0/5e55/0/0/NN/%/%/bridge"
    assert declared.subscribes[0].key == f"0/mark/{STRING}"
    assert "/%/%/bridge/%mark/" in declared.subscribes[0].token


def test_humble_has_no_hashes() -> None:
    declared = node(Settings(ros_distro="humble"), "5e55")
    assert declared.subscribes[0].key == "0/actum/kinect0/mark/std_msgs::msg::dds_::String_/TypeHashNotSupported"
    assert "RIHS01" not in " ".join(topic.token for topic in declared.publishes)


def test_an_attachment_is_number_time_and_who_put_it() -> None:
    one, other = node(Settings(), "5e55").publishes[:2]
    number, put_ns, length = struct.unpack_from("<qqB", one.attachment(1, 2))
    assert (number, put_ns, length, len(one.attachment(1, 2))) == (1, 2, 16, 33)
    assert one.attachment(1, 2)[17:] == one.attachment(9, 9)[17:] != other.attachment(1, 2)[17:]


@pytest.mark.parametrize("namespace", ["a-b", "1a", "a//b", "a/*", "a b"])
def test_what_is_no_ros_name_is_refused(namespace) -> None:
    with pytest.raises(ValidationError, match="is not a ROS namespace: in --ros-namespace"):
        Settings(ros_namespace=namespace)


def test_a_sensor_whose_name_ros_cannot_have_needs_a_namespace() -> None:
    with pytest.raises(ValidationError) as refused:
        Settings(sensor="cam-1")
    assert complaint(refused.value).startswith("settings: 'actum/cam-1' is not a ROS namespace")
    assert Settings(sensor="cam-1", ros_namespace="cam_1").namespace == "cam_1"
