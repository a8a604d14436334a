"""`actum ros2`: the bridge to ROS 2."""

from actum.runtime import needs_extra, run_bridge
from actum_command.commands.service_flags import with_bridge_flags
from actum_command.service_settings import BRIDGE, Given, arguments_of
from ros2_bridge.settings import Settings


@with_bridge_flags
def ros2(*, given: Given) -> None:
    """Exchange messages with ROS 2 until Ctrl-C: publish skeletons, objects and events; receive start and end marks.

    The ROS 2 nodes have to use rmw_zenoh and the same router (--connect). ROS 2 need not be installed on this machine.
    """
    with needs_extra("ros2"):
        from ros2_bridge.bridge import Ros2Bridge
    run_bridge(Settings, Ros2Bridge, arguments_of(BRIDGE, given))
