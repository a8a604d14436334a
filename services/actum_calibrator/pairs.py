"""Pairs of pictures that two cameras took at the same time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from actum_calibrator.board_views import View

SUFFIXES = ("_a", "_b")
"""Endings of the names of a pair's pictures: of the marker camera, and of the people camera."""

PICTURES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")
"""File name extensions of pictures in a folder."""


class PairingError(ValueError):
    """Files that form no pairs; the message names them, and the names that are needed."""


@dataclass(frozen=True)
class Pair:
    """Views of the board from the marker camera and from the people camera at the same time."""

    name: str
    markers: View
    people: View


def pair_files(paths: Sequence[Path]) -> list[tuple[str, Path, Path]]:
    """Pair the files of two folders by name, or files by their name before `_a` (markers) and `_b` (people).

    Returns (name, the marker camera's file, the people camera's file) of each pair.

    Raises:
        PairingError: a picture has no partner or several.
    """
    if len(paths) == 2 and all(path.is_dir() for path in paths):
        sides = [_by_name(pictures_in(path), lambda path: path.stem) for path in paths]
    else:
        files = [file for path in paths for file in (pictures_in(path) if path.is_dir() else [path])]
        if stray := next((file.name for file in files if not file.stem.endswith(SUFFIXES)), None):
            raise PairingError(
                f"the name of the picture {stray} ends neither in _a nor in _b: let the names of pictures from the "
                "camera that sees the markers end in _a, and the others in _b. Or give one folder per camera"
            )
        sides = [_by_name([f for f in files if f.stem.endswith(end)], lambda f: f.stem[:-2]) for end in SUFFIXES]
    if alone := sorted(set(sides[0]) ^ set(sides[1])):
        raise PairingError(
            f"only one of the two cameras has pictures named {', '.join(alone)}: add pictures of the same names from "
            "the second camera, or remove these pictures"
        )
    return [(name, sides[0][name], sides[1][name]) for name in sorted(sides[0])]


def pictures_in(folder: Path) -> list[Path]:
    """List a folder's images by name."""
    return sorted(file for file in folder.iterdir() if file.suffix.lower() in PICTURES)


def _by_name(files: Sequence[Path], name_of: Callable[[Path], str]) -> dict[str, Path]:
    named: dict[str, Path] = {}
    for file in files:
        if name_of(file) in named:
            raise PairingError(
                f"{named[name_of(file)]} and {file} have the same name but for folder and file type. Pictures of two "
                "cameras are paired by their names, so these two could not be told apart: delete or rename one of them"
            )
        named[name_of(file)] = file
    return named
