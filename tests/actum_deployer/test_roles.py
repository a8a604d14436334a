"""The table of roles allows each service what it does, and nobody what is another's."""

from collections.abc import Sequence
from typing import Any

import pytest
import zenoh

from action_fusion.node import ActionFusion
from actum import keys
from actum.keys import Topic
from actum.node import replay
from actum.settings import NodeSettings
from actum_command.service_settings import SETTINGS
from actum_deployer.access_control import TOLD, access_control, link_rules, rules
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.roles import (
    BODIES_BRIDGE,
    BRIDGE,
    DETECTOR,
    GATEWAY,
    IMAGES,
    PAGE,
    PEOPLES,
    ROBOT,
    ROLES,
    SWITCH,
    VIEWER,
    Role,
    identity,
)
from conftest import NEEDS_ROS2_EXTRA
from marker_tracker.node import MarkerTracker
from model_trainer.trainer import ModelTrainer
from node_cases import CASES, Case
from pose_preprocessor.node import PosePreprocessor
from som_classifier.node import SomClassifier
from web_dashboard.node import WebDashboard

BY_SERVICE = {service: role for role in ROLES for service in role.services}
NODES = (PosePreprocessor, SomClassifier, MarkerTracker, ActionFusion, ModelTrainer, WebDashboard)
HOSTS = hosts_of("camera=a,compute=b")
DEPLOYED = {
    "with a bridge": (
        access_control(Deployment(HOSTS, passwords=True, ros_domain=0)),
        {identity(role, "kinect0") for role in ROLES if role not in (BODIES_BRIDGE, DETECTOR)},
    ),
    "with a bridge that reads bodies": (
        access_control(Deployment(HOSTS, passwords=True, ros_domain=0, ros_bodies="camera_optical_frame")),
        {identity(role, "kinect0") for role in ROLES if role is not BRIDGE},
    ),
}
"""The access control of deployments with everybody who can take part, and the identities of these."""
everybody = pytest.mark.parametrize(("section", "identities"), DEPLOYED.values(), ids=DEPLOYED)


def allowed(role: Role, flow: str, message: str, ros_domain: int | None = None) -> set[str]:
    """The key expressions on which a role may send (ingress) or receive (egress) a kind of message."""
    own = [rule for rule in rules(role, "kinect0", ros_domain) if flow in rule["flows"] and message in rule["messages"]]
    return {expression for rule in own for expression in rule["key_exprs"]}


def patterns(topics: Sequence[Topic], sensor: str = "kinect0") -> set[str]:
    return {keys.pattern(topic, sensor) for topic in topics}


def test_what_each_service_reads_is_compared_with_its_role() -> None:
    sources_and_bridges = {"sensor_gateway", "marker_camera", "ros2_bridge"}
    assert {node.name for node in NODES} == BY_SERVICE.keys() - sources_and_bridges


@pytest.mark.parametrize("node", NODES, ids=lambda node: node.name)
def test_a_service_may_read_what_its_node_reads(node: type) -> None:
    assert {*node.inputs} <= {*BY_SERVICE[node.name].reads}


@pytest.mark.parametrize("case", CASES, ids=repr)
def test_a_service_may_put_what_its_node_puts(case: Case) -> None:
    node = case.build()
    answers = replay(node, ((message.stamp_ns or 0, message) for message in case.messages()))
    put = {keys.address_of(answer).topic for answer in answers}
    assert bool(put) == bool(BY_SERVICE[node.name].puts)
    assert put <= {*BY_SERVICE[node.name].puts}


def test_only_gateways_put_what_is_seen_and_images_go_to_whom_they_concern() -> None:
    assert {role.name for role in ROLES if {*IMAGES} & {*role.puts}} == {"gateway"}
    assert {role.name for role in ROLES if keys.SKELETON in role.puts} == {"gateway", "ros2_bodies"}
    assert {role.name for role in ROLES if {*IMAGES} & {*role.reads}} == {
        *("tracker", "page", "recorder"),
        "ros2",  # takes the camera from them, to say where people are in the image
    }


def test_who_marks_is_who_may_switch_and_the_classifier_that_finds() -> None:
    assert {role.name for role in ROLES if keys.SEGMENT in role.puts} == {
        *("switch", "page", "classifier"),
        *("ros2", "ros2_bodies"),
    }


def test_a_service_speaks_for_its_own_sensor_alone() -> None:
    said = set.union(*(allowed(GATEWAY, "ingress", kind) for kind in ("put", "reply", "liveliness_token")))
    assert said
    assert all(expression.startswith("actum/kinect0/") for expression in said)


@pytest.mark.parametrize("role", [role for role in ROLES if role.serves_several], ids=lambda role: role.name)
def test_who_serves_several_sensors_may_do_for_each_what_it_may_for_one_and_nothing_for_others(role: Role) -> None:
    def wordings(sensors: str) -> set[tuple[str, str, str]]:
        """What is allowed: the flow, the kind of message and the key expression."""
        return {
            (flow, message, expression)
            for rule in rules(role, sensors, None)
            for flow in rule["flows"]
            for message in rule["messages"]
            for expression in rule["key_exprs"]
        }

    assert wordings("left,right") == wordings("left") | wordings("right")
    assert all(expression.split("/")[1] in ("left", "right") for *_, expression in wordings("left,right"))


def test_who_serves_several_sensors_is_a_service_whose_settings_name_several() -> None:
    able = {service for service, declared in SETTINGS.items() if issubclass(declared, NodeSettings)}
    assert able == {service for role in ROLES if role.serves_several for service in role.services}


def test_a_certificate_for_several_sensors_is_none_of_one_of_them() -> None:
    hosts = hosts_of("camera1=a,camera2=b,compute=c", "left,right")
    subjects = access_control(Deployment(hosts))["subjects"]
    names = {name for subject in subjects for name in subject["cert_common_names"]}
    assert {"classifier.left+right", "page.left", "page.right", "gateway.left", "tracker.right"} <= names
    assert names.isdisjoint({"classifier.left", "classifier.right", "page.left+right"})


def test_a_viewer_says_nothing_and_asks_only_who_is_there() -> None:
    for kind in ("put", "delete", "reply", "declare_queryable", "liveliness_token"):
        assert allowed(VIEWER, "ingress", kind) == set()
    assert not any("command" in expression for expression in allowed(VIEWER, "ingress", "query"))
    assert any("command" in expression for expression in allowed(SWITCH, "ingress", "query"))


def test_the_page_asks_only_services_of_its_own_sensor_to_do_something() -> None:
    for flow, message in (("ingress", "query"), ("egress", "reply"), ("ingress", "liveliness_query")):
        about_sensors = {each for each in allowed(PAGE, flow, message) if not each.startswith("@/")}
        assert about_sensors
        assert all(each.startswith("actum/kinect0/") for each in about_sensors)
    assert "actum/kinect0/command/**" in allowed(PAGE, "ingress", "query")
    assert "actum/*/command/**" in allowed(SWITCH, "ingress", "query")


@pytest.mark.parametrize("role", ROLES, ids=lambda role: role.name)
def test_what_is_received_is_what_is_read(role: Role) -> None:
    sensor = "kinect0" if role.services else "*"
    got = {each for each in allowed(role, "egress", "put") if "@adv" not in each}
    assert got == patterns(role.reads, sensor)


@everybody
def test_every_identity_has_a_policy_and_every_rule_is_somebodys(section: dict[str, Any], identities: set[str]) -> None:
    assert section["default_permission"] == "deny"
    assert {subject["id"] for subject in section["subjects"]} == {*identities, "router.camera", "router.compute"}
    used = [rule for policy in section["policies"] for rule in policy["rules"]]
    assert {rule["id"] for rule in section["rules"]} == {*used}
    assert used.count(TOLD) == len(identities)
    assert {rule["permission"] for rule in section["rules"]} == {"allow"}


@everybody
def test_people_are_known_by_certificate_and_user_and_routers_by_certificate(
    section: dict[str, Any], identities: set[str]
) -> None:
    assert {subject["id"] for subject in section["subjects"] if "usernames" in subject} == identities


def test_every_role_takes_part_in_some_deployment() -> None:
    assert {identity(role, "kinect0") for role in ROLES} == set.union(*(them for _, them in DEPLOYED.values()))
    assert {role.name for role in PEOPLES} <= set.union(*(them for _, them in DEPLOYED.values()))


def test_the_bridge_to_ros_may_put_and_read_what_its_table_says_and_a_robot_the_other_side() -> None:
    pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)
    from ros2_bridge.bridge import Ros2Bridge
    from ros2_bridge.settings import Settings

    bridge = Ros2Bridge(Settings(ros_domain_id=7))
    assert {*bridge.inputs} == {*BRIDGE.reads}
    node = bridge.foreign_node("5e55")
    for topics, ours, theirs in ((node.publishes, "ingress", "egress"), (node.subscribes, "egress", "ingress")):
        for topic in topics:
            key = zenoh.KeyExpr(topic.key)
            for role, flow, other in ((BRIDGE, ours, theirs), (ROBOT, theirs, ours)):
                assert any(zenoh.KeyExpr(each).includes(key) for each in allowed(role, flow, "put", 7))
                assert not any(zenoh.KeyExpr(each).intersects(key) for each in allowed(role, other, "put", 7))
                assert not any(zenoh.KeyExpr(each).intersects(key) for each in allowed(role, flow, "put", 0))
    body, person, intents = (
        zenoh.KeyExpr(f"7/{it}/type/hash") for it in ("humans/bodies/a/roi", "humans/persons/a/action", "intents")
    )
    for role, flow in ((BRIDGE, "ingress"), (ROBOT, "egress")):
        for key in (body, person, intents):
            assert any(zenoh.KeyExpr(each).includes(key) for each in allowed(role, flow, "put", 7))
    for token in (node.token, *(topic.token for topic in (*node.publishes, *node.subscribes))):
        key = zenoh.KeyExpr(token)
        assert any(zenoh.KeyExpr(each).includes(key) for each in allowed(BRIDGE, "ingress", "liveliness_token", 7))


def test_bodies_are_put_by_detectors_and_read_by_the_bridge_that_makes_skeletons_of_them() -> None:
    pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)
    from ros2_bridge.bridge import Ros2Bridge
    from ros2_bridge.settings import Settings

    settings = Settings(ros_domain_id=7, ros_bodies=True, ros_frame_id="camera_optical_frame")
    for topic in Ros2Bridge(settings).foreign_node("5e55").subscribes:
        key = zenoh.KeyExpr(topic.key)
        for role, flow in ((BODIES_BRIDGE, "egress"), (DETECTOR, "ingress")):
            assert any(zenoh.KeyExpr(each).includes(key) for each in allowed(role, flow, "put", 7)), topic.key
            assert not any(zenoh.KeyExpr(each).intersects(key) for each in allowed(role, flow, "put", 0))
        if topic.name != "mark":
            for role, flow in ((BRIDGE, "egress"), (ROBOT, "ingress")):
                assert not any(zenoh.KeyExpr(each).intersects(key) for each in allowed(role, flow, "put", 7)), topic.key


def test_a_bridge_that_reads_bodies_puts_none_and_reads_what_its_step_takes() -> None:
    pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)
    from ros2_bridge.bridge import Ros2Bridge
    from ros2_bridge.settings import Settings

    for role, settings in (
        (BRIDGE, Settings()),
        (BODIES_BRIDGE, Settings(ros_bodies=True, ros_frame_id="camera_optical_frame")),
    ):
        assert {*role.reads} == {*Ros2Bridge(settings).inputs}
    forged = zenoh.KeyExpr("7/humans/bodies/tracked/type/hash")
    assert not any(zenoh.KeyExpr(each).intersects(forged) for each in allowed(BODIES_BRIDGE, "ingress", "put", 7))


def test_detectors_put_no_pictures_of_people_which_would_cross_between_hosts() -> None:
    picture = zenoh.KeyExpr("7/humans/bodies/ab/cropped/type/hash")
    assert not any(zenoh.KeyExpr(each).intersects(picture) for each in allowed(DETECTOR, "ingress", "put", 7))
    assert not any(zenoh.KeyExpr(each).intersects(picture) for each in allowed(BODIES_BRIDGE, "egress", "put", 7))


@pytest.mark.parametrize("role", [ROBOT, DETECTOR], ids=lambda role: role.name)
def test_ros_nodes_have_nothing_of_ours_and_without_a_bridge_nothing_at_all(role: Role) -> None:
    every = {each for rule in rules(role, "", 0) for each in rule["key_exprs"]}
    assert every
    assert not any(each.startswith("actum/") for each in every)
    assert [*rules(role, "", None)] == []


@pytest.mark.parametrize("cross", [False, True])
def test_images_pass_between_routers_only_where_they_may(cross: bool) -> None:
    content = {each for rule in link_rules(cross, None) if "put" in rule["messages"] for each in rule["key_exprs"]}
    assert any("image" in expression for expression in content) == cross
    assert patterns([topic for topic in keys.TOPICS if topic not in IMAGES], "*") <= content
