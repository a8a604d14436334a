"""Run the fusion of actions and objects: `python -m action_fusion`."""

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.runtime import run


def main() -> None:
    """Serve until SIGTERM."""
    run(Settings, ActionFusion)


if __name__ == "__main__":
    main()
