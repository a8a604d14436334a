"""`python -m som_classifier`."""

from actum.runtime import run
from som_classifier.node import SomClassifier
from som_classifier.settings import Settings


def main() -> None:
    """Serve until SIGTERM."""
    run(Settings, SomClassifier.configured)


if __name__ == "__main__":
    main()
