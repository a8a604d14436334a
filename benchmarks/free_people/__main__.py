"""`python -m benchmarks.free_people`: makes the background that comes with actum."""

from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.free_people.movement import free_movement

from actum.recorder import Recorder
from actum.recording import Recording
from actum_model_trainer.background import SHIPPED, save
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import LabelledStream

PEOPLE = range(2001, 2017)
"""Numbers that no other simulated person has."""
SECONDS = 120.0
"""Of each: enough that each does most of what there is."""


def made() -> list[LabelledStream]:
    """Return the people's streams, as the classifier would get them."""
    with TemporaryDirectory(prefix="actum-background-") as folder:
        recordings = []
        for person in PEOPLE:
            path = Path(folder) / f"{person}.mcap"
            with Recorder(path, person=str(person), source="simulator") as recorder:
                for skeleton in free_movement(person, SECONDS, "kinect0"):
                    recorder.write(skeleton)
            recordings.append(Recording(path))
        return samples_from(recordings).streams


if __name__ == "__main__":
    save(made(), SHIPPED)
