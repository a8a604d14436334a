"""`python -m pose_preprocessor`."""

from actum.runtime import run
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings


def main() -> None:
    """Serve until SIGTERM."""
    run(Settings, PosePreprocessor)


if __name__ == "__main__":
    main()
