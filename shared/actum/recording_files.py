"""The recordings that lie in folders: those that are finished, and what can be read of the others."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from actum.atomic_file import UNFINISHED
from actum.recording import Recording, RecordingError

SUFFIX = ".mcap"
"""Ending of finished recordings."""


@dataclass
class RecordingFiles:
    """Files of recordings, in order.

    Attributes:
        paths: each once.
        unfinished: those of them that are being written, or were when a process ended.
        left_out: of each unfinished file that is not among them, why.
    """

    paths: list[Path] = field(default_factory=list)
    unfinished: list[Path] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)

    @property
    def remarks(self) -> list[str]:
        """What to tell whoever named the folders, in lines."""
        begun = [f"{file} is not finished: its messages so far are read" for file in self.unfinished]
        return [*begun, *self.left_out]


def recording_files(named: Iterable[Path]) -> RecordingFiles:
    """List files as they are named, and all recordings below folders, without those in hidden folders there.

    The newest recording of a history, and one that a crash has broken off, is an unfinished file.
    """
    found = RecordingFiles()
    for path in named:
        if path.is_dir():
            _search(path, found)
        else:
            found.paths.append(path)
    found.paths = list({path.resolve(): path for path in found.paths}.values())
    return found


def _search(folder: Path, found: RecordingFiles) -> None:
    files = [file for ending in (SUFFIX, SUFFIX + UNFINISHED) for file in folder.rglob(f"*{ending}")]
    for file in sorted(files):
        if any(part.startswith(".") for part in file.relative_to(folder).parts):
            continue
        if file.suffix == UNFINISHED:
            _take_unfinished(file, found)
        else:
            found.paths.append(file)


def _take_unfinished(file: Path, found: RecordingFiles) -> None:
    finished = file.with_suffix("")
    if finished.exists():
        found.left_out.append(f"{file} is not read, because the finished recording {finished} exists as well")
        return
    try:
        Recording(file)
    except RecordingError as error:
        found.left_out.append(f"not read: {error}")
        return
    found.paths.append(file)
    found.unfinished.append(file)
