"""A classifier whose model finds an action in every second: a program for tests of live processes."""

from actum.runtime import run
from recognisers import tiny_model
from som_classifier.node import SomClassifier
from som_classifier.settings import Settings
from spotters import beating


def build(settings: Settings) -> SomClassifier:
    return SomClassifier(beating(tiny_model()), segmentation=settings.segmentation)


if __name__ == "__main__":
    run(Settings, build)
