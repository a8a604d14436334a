"""`python -m ros2_bridge`."""

from actum.runtime import needs_extra, run_bridge

with needs_extra("ros2"):
    from ros2_bridge.bridge import Ros2Bridge
    from ros2_bridge.settings import Settings


def main() -> None:
    """Serve until SIGTERM."""
    run_bridge(Settings, Ros2Bridge)


if __name__ == "__main__":
    main()
