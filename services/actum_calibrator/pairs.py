"""Which pictures of two cameras were taken at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from actum_calibrator.board_views import View

SUFFIXES = ("_a", "_b")
"""How the names of a pair's pictures end: of the camera that sees markers, and of the one that sees people."""

PICTURES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")
"""Endings of the files in a folder that are taken for pictures."""


class PairingError(ValueError):
    """Files that make no pairs: which, and how to name them."""


@dataclass(frozen=True)
class Pair:
    """The board as the camera that sees markers and the one that sees people see it at one time."""

    name: str
    markers: View
    people: View


def pair_files(paths: Sequence[Path]) -> list[tuple[str, Path, Path]]:
    """Pair two folders by file name, or files by name before `_a` (sees markers) and `_b` (sees people).

    Raises:
        PairingError: a picture has no partner or several.
    """
    if len(paths) == 2 and all(path.is_dir() for path in paths):
        sides = [_by_name(pictures_in(path), lambda path: path.stem) for path in paths]
    else:
        files = [file for path in paths for file in (pictures_in(path) if path.is_dir() else [path])]
        if strays := [file.name for file in files if not file.stem.endswith(SUFFIXES)]:
            raise PairingError(f"{strays[0]}: name pictures NAME_a and NAME_b, or give two folders")
        sides = [_by_name([f for f in files if f.stem.endswith(end)], lambda f: f.stem[:-2]) for end in SUFFIXES]
    if alone := sorted(set(sides[0]) ^ set(sides[1])):
        raise PairingError(f"{', '.join(alone)}: only one camera's picture is there; add the other's or leave it out")
    return [(name, sides[0][name], sides[1][name]) for name in sorted(sides[0])]


def pictures_in(folder: Path) -> list[Path]:
    """List a folder's images by name."""
    return sorted(file for file in folder.iterdir() if file.suffix.lower() in PICTURES)


def _by_name(files: Sequence[Path], name_of: Callable[[Path], str]) -> dict[str, Path]:
    named: dict[str, Path] = {}
    for file in files:
        if name_of(file) in named:
            raise PairingError(f"{file.name}: two pictures of that name; keep one")
        named[name_of(file)] = file
    return named
