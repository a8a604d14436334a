"""`actum ros2`: the bridge to ROS 2."""

from actum.runtime import needs_extra, run_bridge
from actum_command.commands.service_flags import with_bridge_flags
from actum_command.service_settings import BRIDGE, Given, arguments_of
from ros2_bridge.settings import Settings


@with_bridge_flags
def ros2(*, given: Given) -> None:
    """Publish skeletons, objects and events on ROS 2 topics over rmw_zenoh, and receive marks, until Ctrl-C.

    ROS 2 need not be installed here. ACTUM_CONNECT names the router, which the ROS 2 nodes share.
    """
    with needs_extra("ros2"):
        from ros2_bridge.bridge import Ros2Bridge
    run_bridge(Settings, Ros2Bridge, arguments_of(BRIDGE, given))
