"""A deployment whose skeletons come from the bodies that ROS 2 nodes track."""

from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.programs import Data, environment, programs
from actum_deployer.roles import BODIES_BRIDGE, BRIDGE

HOSTS = hosts_of("camera=192.168.1.5,compute=192.168.1.6")


def running(deployment: Deployment, host: str) -> dict[str, dict[str, str]]:
    """The settings of each program of a host."""
    [here] = [each for each in deployment.hosts if each.name == host]
    data = Data("models", "state")
    return {
        program.name: environment(deployment, here, program, "127.0.0.1", data)
        for program in programs(deployment, here)
    }


def test_the_bridge_takes_the_place_of_the_gateway_and_knows_the_cameras_frame() -> None:
    with_bodies = Deployment(HOSTS, ros_domain=3, ros_bodies="camera_optical_frame")
    assert "sensor_gateway" not in running(with_bodies, "camera")
    bridge = running(with_bodies, "compute")["ros2_bridge"]
    assert bridge["ACTUM_ROS_DOMAIN_ID"] == "3"
    assert (bridge["ACTUM_ROS_BODIES"], bridge["ACTUM_ROS_FRAME_ID"]) == ("true", "camera_optical_frame")
    assert bridge["ACTUM_CREDENTIALS"].endswith("/ros2_bodies.kinect0")


def test_without_bodies_the_gateway_runs_and_the_bridge_reads_none() -> None:
    without = Deployment(HOSTS, ros_domain=3)
    assert "sensor_gateway" in running(without, "camera")
    assert "ACTUM_ROS_BODIES" not in running(without, "compute")["ros2_bridge"]


def test_a_deployment_has_one_of_the_two_bridges_and_only_with_bodies_detectors() -> None:
    for bodies, own, other in ((None, BRIDGE, BODIES_BRIDGE), ("camera", BODIES_BRIDGE, BRIDGE)):
        deployment = Deployment(HOSTS, ros_domain=3, ros_bodies=bodies)
        roles = [role for role, _ in deployment.subjects]
        assert own in roles
        assert other not in roles
        assert ("detector" in {role.name for role in deployment.peoples}) == (bodies is not None)
