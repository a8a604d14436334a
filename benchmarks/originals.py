"""The recordings that benchmarks are run on: public sets below the folder that ACTUM_DATA names."""

import os
from collections.abc import Callable
from pathlib import Path

from actum.recording import Recording
from actum_dataset_importer.importing import ImportReport, Progress
from actum_model_trainer.sample_reading import select

Import = Callable[[Path, Path, Progress], ImportReport]


def original(name: str) -> Path:
    """Return the file or folder of a set; end the program where it is not there."""
    path = Path(os.environ.get("ACTUM_DATA", "")) / name
    if not os.environ.get("ACTUM_DATA") or not path.exists():
        raise SystemExit(f"set ACTUM_DATA to the folder that holds {name}")
    return path


class ImportedSets:
    """The sets, each imported into one folder when first asked for."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def recordings(
        self, name: str, import_set: Import, progress: Progress = lambda done, total: None
    ) -> list[Recording]:
        """Return the recordings of a set, imported in one of the ways in which it may be."""
        imported = self.folder / import_set.__name__
        if not imported.exists():
            import_set(original(name), imported, progress)
        return select([imported])
