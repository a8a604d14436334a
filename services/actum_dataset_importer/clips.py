"""Video clips named with an action and a person, as labelled takes: the whole clip is one segment."""

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from actum.messages import segment_marks
from actum.node import Counters
from actum_dataset_importer.takes import DatasetError, Take
from sensor_gateway.devices.video import SUFFIXES, VideoError, pictures_of
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Estimator
from sensor_gateway.perceiver import Perceiver

DEFAULT_PATTERN = r"(?P<action>[^_]+)_(?P<person>[^_]+)(_.*)?"
"""Matches names such as `wave_anna` and `wave_anna_2`: the action, the person, anything."""

NOT_IN_NAMES = re.compile(r"[^\w.-]+")
"""Characters that some file systems do not allow in names."""


@dataclass(frozen=True)
class Naming:
    """How a clip's file name, without its ending, gives the action and the person.

    Attributes:
        pattern: matches the whole name; has a group `action`, and may have one `person`.
        actions: other names for what the group `action` matches.
    """

    pattern: re.Pattern[str]
    actions: Mapping[str, str]

    @classmethod
    def of(cls, pattern: str, names: str) -> "Naming":
        """Parse the command line's regular expression, and names such as `1=wave,2=drink`.

        Raises:
            DatasetError: either is not of that form.
        """
        try:
            compiled = re.compile(pattern)
        except re.error as error:
            raise DatasetError(
                f"--pattern {pattern!r} is not a valid regular expression ({error}): correct the expression"
            ) from None
        if "action" not in compiled.groupindex:
            raise DatasetError(
                f"--pattern {pattern!r} does not say which part of a file name is the action: enclose that part in "
                "(?P<action>…)"
            )
        pairs = [pair.partition("=") for pair in names.split(",") if pair]
        if not all(key.strip() and name.strip() for key, _, name in pairs):
            raise DatasetError(
                f"--names {names!r} does not have the form NUMBER=NAME,NUMBER=NAME: write for example 1=wave,2=drink"
            )
        return cls(compiled, {key.strip(): name.strip() for key, _, name in pairs})

    def read(self, path: Path) -> tuple[str, str]:
        """Return a clip's action and person ("" where the name gives none).

        Raises:
            DatasetError: the name does not match.
        """
        match = self.pattern.fullmatch(path.stem)
        action = "" if match is None else (match["action"] or "").strip()
        if match is None or not action:
            raise DatasetError(
                f"{path.name} is not imported, because --pattern {self.pattern.pattern!r} finds no action in this "
                "file name: rename the file, or give a --pattern whose group `action` matches part of the file name"
            )
        person = match["person"] if "person" in self.pattern.groupindex else ""
        return self.actions.get(action, action), (person or "").strip()


def clip_files(folder: Path) -> list[Path]:
    """List the clips of a folder and of those below it, in order of name.

    Raises:
        DatasetError: there is none.
    """
    files = sorted(file for file in folder.rglob("*") if file.suffix.lower() in SUFFIXES)
    if not files:
        raise DatasetError(
            f"{folder} contains no video file ({', '.join(sorted(SUFFIXES))}): give a folder with videos"
        )
    return files


def recording_name(path: Path) -> str:
    """Return the name of a clip's recording: the clip's, unusual characters replaced."""
    return NOT_IN_NAMES.sub("_", path.stem)


def check_names(files: Sequence[Path]) -> None:
    """Check that no two clips get the same recording.

    Raises:
        DatasetError: two would.
    """
    taken: dict[str, Path] = {}
    for file in files:
        other = taken.setdefault(recording_name(file).casefold(), file)
        if other is not file:
            raise DatasetError(
                f"{other} and {file} would both become {recording_name(file)}.mcap: rename one of the two"
            )


def read_clip(
    path: Path, naming: Naming, sensor: str, optics: Optics, opened: Callable[[], AbstractContextManager[Estimator]]
) -> Take:
    """Estimate the poses in a clip as the camera source does; `opened` makes a new estimator for each clip.

    Raises:
        DatasetError: the name gives no action, or the file is no video.
    """
    action, person = naming.read(path)
    name, counters = recording_name(path), Counters()
    try:
        with opened() as estimator:
            perceiver = Perceiver(estimator, optics, sensor, name, counters)
            frames = [perceiver.skeleton(picture) for picture in pictures_of(path)]
    except VideoError as error:
        raise DatasetError(str(error)) from None
    marks = segment_marks(frames[0].stamp_ns, frames[-1].stamp_ns, sensor, name, action)
    return Take(name, person, frames, marks, {"lens": str(optics)}, oddities=Counter(counters.rejects))
